// What a recording says of a model's motion, frame by frame: rows that are linear in the positions
// of the model's nodes.
#ifndef LACUNA_STUDY_OBSERVER_H_
#define LACUNA_STUDY_OBSERVER_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "geometry/embedding.h"
#include "geometry/tet_mesh.h"
#include "scan/recording.h"

namespace lacuna {

// y = W x for stacked node positions x (3n) or their derivatives (3n × k), W held by rows.
struct LinearRows {
  std::vector<int> begin{0};   // of row i's entries; rows + 1
  std::vector<int> column;     // of 3n
  std::vector<double> weight;  // ∂y/∂x

  int Count() const { return static_cast<int>(begin.size()) - 1; }
  Eigen::MatrixXd operator*(const Eigen::Ref<const Eigen::MatrixXd>& nodal) const;
};

// One frame, as it is compared with the model: predicted minus measured is W x − target, `target`
// in m. Row (components·i + c) is component c of point i.
struct Observed {
  std::shared_ptr<const LinearRows> rows;
  Eigen::VectorXd target;
  Eigen::VectorXi count;      // points: measurements that each is the mean of; 0: not seen
  Eigen::Matrix3Xd measured;  // 3 × points, m, where it was measured; NaN where not seen
  // Of points of three components, F = ∂x/∂X at each in the model: how an error of its place on the
  // object shows in this frame. Empty: as in all others.
  std::vector<Eigen::Matrix3d> deformation;
  // Along which a point of one component is measured: 3 × points, unit length; 3 × 0 of three.
  Eigen::Matrix3Xd normal;
  int offered = 0, used = 0;  // scanned points in the frame, and those that were compared
};

class Observer {
 public:
  virtual ~Observer() = default;
  virtual int PointCount() const = 0;
  virtual int Components() const = 0;  // of a point: 3, or 1 along the surface's normal
  // Places of the points on the undeformed object, 3 × points, m.
  virtual const Eigen::Matrix3Xd& Places() const = 0;
  // Of frame `frame`, for the model's nodes near `position` (3n): which point of the model a
  // scanned point is depends on where the model is.
  virtual Observed Observe(int frame, const Eigen::VectorXd& position) const = 0;
};

// Markers, at their places in the mesh: predicted and measured position of each.
class MarkerObserver : public Observer {
 public:
  // Both must outlive it.
  MarkerObserver(const Recording& recording, const TetMesh& mesh);
  int PointCount() const override { return static_cast<int>(recording_.markers.places.cols()); }
  int Components() const override { return 3; }
  const Eigen::Matrix3Xd& Places() const override { return recording_.markers.places; }
  Observed Observe(int frame, const Eigen::VectorXd& position) const override;
  const Embedding& places_in_mesh() const { return places_; }
  // x, y, z of each marker from the nodes.
  const LinearRows& rows() const { return *rows_; }
  // F at each marker, for the model's nodes at `position` (3n).
  std::vector<Eigen::Matrix3d> DeformationAt(const Eigen::VectorXd& position) const;

 private:
  const Recording& recording_;
  const TetMesh& mesh_;
  Embedding places_;
  std::shared_ptr<const LinearRows> rows_;
};

}  // namespace lacuna

#endif  // LACUNA_STUDY_OBSERVER_H_
