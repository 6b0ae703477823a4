// The motions that the grips of a recording prescribe to the model.
#ifndef LACUNA_EXPERIMENT_GRIP_TRACKS_H_
#define LACUNA_EXPERIMENT_GRIP_TRACKS_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "fem/model.h"
#include "scan/recording.h"

namespace lacuna {

// The indices, in the recording, of the markers that a grip follows.
std::vector<int> MarkersOf(const RecordedGrip& grip, const Recording& recording);

// Fixed regions do not move. A gripped region moves as a rigid body or, where the recording says
// that it deforms, by an affine map. It follows a given path, its markers or the scanned surface.
// Between the rows of a path, and between frames, the positions lie on a smooth path, which goes on
// after the last of them (geometry/smooth_path.h): of a given path that of the displacement and the
// rotation vector (MotionAt(), scan/recorded_grip.h), otherwise that of each node. The latter is
// not quite rigid: a grip that turns by the angle φ after the last frame is stretched by φ².
class GripTracks {
 public:
  // Adds a grip to the model for each fixed and gripped region of the recording. Throws InputError
  // when their nodes contradict each other (held_parts.h).
  GripTracks(const Recording& recording, const TetMesh& reference, Model* model);

  // Declares the body undeformed at this time (s): all grips are at their rest positions there, and
  // the motion along a given path counts from there. Until then they are at rest in the first frame
  // of the recording, and a path counts from its first row.
  void Begin(double time);
  // Adds the positions of the grips at `time`. `before` and `moved` (3 × nodes) are the model's
  // nodes and the places to which the registered motion of the scan carries them; `markers` (3 × m)
  // are all markers of the recording in this frame, NaN where one was not seen. A grip is not
  // placed where too few of its markers are seen to determine its motion; one such grip is
  // returned, otherwise null.
  const RecordedGrip* Extend(double time, const Eigen::Matrix3Xd& before,
                             const Eigen::Matrix3Xd& moved, const Eigen::Matrix3Xd& markers);
  // Sets the gripped nodes of a stacked position (3n) to their positions at `time`.
  void Place(double time, Eigen::VectorXd* position) const;

 private:
  struct Track {
    RecordedGrip grip;
    Eigen::VectorXi nodes;
    Eigen::Matrix3Xd rest;     // rest positions of the nodes
    std::vector<int> markers;  // columns of the marker tracks
    int span = 0;              // dimension of their places (geometry/rigid_fit.h)
    // Ascending, s. At the first of them a part on a given path is at its rest place; it needs no
    // others.
    std::vector<double> times;
    std::vector<Eigen::Matrix3Xd> places;  // positions of the nodes at these times

    Eigen::Matrix3Xd At(double time) const;
    void RestAt(double time);
    // The positions at a time that is not before the latest.
    void Add(double time, Eigen::Matrix3Xd place);
  };
  const Recording& recording_;
  const Model& model_;
  std::vector<std::shared_ptr<Track>> tracks_;
};

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_GRIP_TRACKS_H_
