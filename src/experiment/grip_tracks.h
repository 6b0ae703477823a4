// The grips of a recording, as the model's prescribed motions.
#ifndef LACUNA_EXPERIMENT_GRIP_TRACKS_H_
#define LACUNA_EXPERIMENT_GRIP_TRACKS_H_

#include <Eigen/Core>
#include <map>
#include <memory>
#include <vector>

#include "fem/model.h"
#include "scan/recording.h"

namespace lacuna {

// The markers that a grip follows, by their order in the recording.
std::vector<int> MarkersOf(const RecordedGrip& grip, const Recording& recording);

// Fixed regions stay where they rest. A gripped region moves as a rigid body, or, where it deforms,
// affinely: along its given path, with its markers, or as the scanned surface moves there; of the
// last two, positions between two frames are interpolated linearly.
class GripTracks {
 public:
  // Adds a grip to the model for each fixed and gripped region of the recording. Throws InputError
  // when a region holds no node, two hold the same, or all are held.
  GripTracks(const Recording& recording, const TetMesh& reference, Model* model);

  // All grips rest at this time.
  void Begin(double time);
  // Adds where the grips are at `time`. `before` and `moved` (3 × nodes): the model's nodes and
  // where the registered motion of the scan carries them; `markers` (3 × m): the frame's markers.
  // A grip so many of whose markers are not seen that the rest tells less of its motion is not
  // placed, and returned (one of them).
  const RecordedGrip* Extend(double time, const Eigen::Matrix3Xd& before,
                             const Eigen::Matrix3Xd& moved, const Eigen::Matrix3Xd& markers);
  // Puts the gripped nodes of a stacked position (3n) where they are at `time`.
  void Place(double time, Eigen::VectorXd* position) const;

 private:
  struct Track {
    RecordedGrip grip;
    Eigen::VectorXi nodes;
    Eigen::Matrix3Xd rest;                      // of the nodes
    std::vector<int> markers;                   // columns of the marker tracks
    int span = 0;                               // of their places (geometry/rigid_fit.h)
    std::map<double, Eigen::Matrix3Xd> places;  // by time; of a given path none
  };
  const Recording& recording_;
  const Model& model_;
  std::vector<std::shared_ptr<Track>> tracks_;
};

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_GRIP_TRACKS_H_
