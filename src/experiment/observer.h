// The measurements of one recording in the form in which they are compared with a model: for each
// frame, rows that are linear in the positions of the model's nodes.
#ifndef LACUNA_EXPERIMENT_OBSERVER_H_
#define LACUNA_EXPERIMENT_OBSERVER_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "experiment/observation_matrix.h"
#include "geometry/embedding.h"
#include "geometry/tet_mesh.h"
#include "scan/recording.h"

namespace lacuna {

// The measurements of one frame. Predicted minus measured is W x − target, in m; row
// components·i + c is component c of point i.
struct Observed {
  std::shared_ptr<const ObservationMatrix> rows;
  Eigen::VectorXd target;
  // For each point: the number of measurements of which it is the mean, or for a marker its weight,
  // (σ/σ_i)² for the noise σ of the recording and σ_i of the marker; 0: not seen.
  Eigen::VectorXd count;
  Eigen::Matrix3Xd measured;  // 3 × points, m, the measured places; NaN where not seen
  // For points of three components, the deformation gradient F = ∂x/∂X of the model at each point,
  // by which an error of the point's place on the object is multiplied. If it is empty, the error
  // is the same in all frames.
  std::vector<Eigen::Matrix3d> deformation;
  // For points of one component, the unit direction of the measurement: 3 × points; else 3 × 0.
  Eigen::Matrix3Xd normal;
  int offered = 0, used = 0;  // scanned points in the frame, and how many of them were compared
  // The mean distance, m, of all scanned points of the frame from the model's surface, where a
  // point farther away than the object's size counts as that far; 0 for markers.
  double distance = 0;
};

// Compares the model with the frames of one recording. Its results depend on the arguments alone,
// so that several threads may use it at once.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual int PointCount() const = 0;
  virtual int Components() const = 0;  // per point: 3, or 1 along the surface normal
  // The places of the points on the undeformed object, 3 × points, m.
  virtual const Eigen::Matrix3Xd& Places() const = 0;
  // Compares frame `frame` with a model whose nodes are near `position` (3n), on which the
  // correspondences of scanned points depend.
  Observed Observe(int frame, const Eigen::VectorXd& position) const {
    return ObserveWithin(1, frame, position);
  }
  // Observe() with `reach_factor` times the reach within which scanned points find their
  // correspondence. A larger factor finds more of them, and more wrong ones.
  virtual Observed ObserveWithin(double reach_factor, int frame,
                                 const Eigen::VectorXd& position) const = 0;
};

// Compares markers, which are embedded in the mesh at their places, or averaged over the subset of
// the recording's instrument (subset_rows.h).
class MarkerObserver : public Observer {
 public:
  // Both arguments must outlive the observer.
  MarkerObserver(const Recording& recording, const TetMesh& mesh);
  int PointCount() const override { return static_cast<int>(recording_.markers.places.cols()); }
  int Components() const override { return 3; }
  const Eigen::Matrix3Xd& Places() const override { return recording_.markers.places; }
  Observed ObserveWithin(double reach_factor, int frame,
                         const Eigen::VectorXd& position) const override;
  const Embedding& places_in_mesh() const { return places_; }
  // The matrix W, with rows x, y and z of each marker.
  const ObservationMatrix& rows() const { return *rows_; }
  // F at each marker, with the model's nodes at `position` (3n).
  std::vector<Eigen::Matrix3d> DeformationAt(const Eigen::VectorXd& position) const;

 private:
  const Recording& recording_;
  const TetMesh& mesh_;
  Embedding places_;
  std::shared_ptr<const ObservationMatrix> rows_;
};

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_OBSERVER_H_
