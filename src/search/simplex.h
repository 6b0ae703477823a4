// The simplex of n + 1 evaluated points and its linear interpolant, shared by both sets of rules.
//
// The notation is that of Powell 1994: the best vertex is the pole x⁰ and the others are x⁰ + s_j.
// Row j of the inverse of (s_1 … s_n) is the gradient of the Lagrange function of vertex j; its
// reciprocal length σ_j is the distance of vertex j from the opposite face, and η_j = ‖s_j‖.
#ifndef LACUNA_SEARCH_SIMPLEX_H_
#define LACUNA_SEARCH_SIMPLEX_H_

#include <Eigen/Core>
#include <optional>

#include "search/evaluator.h"
#include "search/trust_region_step.h"

namespace lacuna {

class Simplex {
 public:
  // Evaluates `start` (n) and one neighbour along each axis, at a distance |step| from the best
  // point so far: on the upper side for a positive `step`, otherwise on the lower side, unless only
  // the other side is wide enough. If the evaluation of a neighbour fails, the other side and then
  // smaller distances are tried; if all fail, the neighbour is assigned a value that exceeds the
  // largest one by at least the range of the values. If the evaluation of the start fails, the
  // first point around it whose evaluation succeeds takes its place. Returns std::nullopt if the
  // search must stop, if all evaluations around the start fail, or if the bounds are too close
  // together for a second point.
  static std::optional<Simplex> Around(const Eigen::VectorXd& start, double step,
                                       Evaluator* evaluator);

  int n() const { return static_cast<int>(vertices_.rows()); }
  int pole() const { return n(); }  // index of the pole among the vertices

  Eigen::VectorXd Vertex(int j) const { return vertices_.col(j); }
  double value(int j) const { return values_[j]; }
  double violation(int j) const { return violations_[j]; }
  Eigen::VectorXd Constraints(int j) const { return constraints_.col(j); }
  // The merit f + penalty · max(0, max_i -c_i) at vertex j.
  double Merit(int j, double penalty) const { return values_[j] + penalty * violations_[j]; }
  // Whether vertex j has less merit than vertex k or, where that is equal and the penalty 0, a
  // smaller violation.
  bool IsBetter(int j, int k, double penalty) const;

  // Makes the vertex of least merit the pole. Returns false if the simplex is degenerate; the
  // functions below must then not be called.
  bool MovePole(double penalty);

  const LinearInterpolant& model() const { return model_; }
  Eigen::VectorXd Offset(int j) const { return offsets_.col(j); }
  double EdgeLength(int j) const { return edge_lengths_[j]; }      // η_j
  double FaceDistance(int j) const { return face_distances_[j]; }  // σ_j
  Eigen::VectorXd FaceNormal(int j) const { return inverse_.row(j) * face_distances_[j]; }
  // The value of the Lagrange function of vertex j < n at x⁰ + step.
  double Lagrange(int j, const Eigen::VectorXd& step) const;

  // Replaces vertex j, which may be the pole, by an evaluated point.
  void Replace(int j, const Eigen::VectorXd& x, const Evaluation& outcome);

  // A geometry step: replaces vertex j < n by an evaluated point at about the distance `length`
  // from the pole along the normal of the face opposite to it, on the side with the better
  // predicted merit, or on the other side if the bounds would shorten the step to less than half
  // and the other step is longer. Where the evaluation fails, the opposite step and then half the
  // step are tried. Returns false, and leaves the vertex as it is, if the bounds permit no such
  // step, if all evaluations fail, or if the search must stop (Evaluator::stopped()).
  bool ReplaceByGeometryPoint(int j, double length, double penalty, Evaluator* evaluator);

  // An upper limit on a useful penalty (Powell 1994, eq. 12 and 13): the range of f over the
  // vertices, divided by the least range of a constraint among those that are violated, or nearly
  // violated, at some vertex. 0 if there is no such constraint.
  double PenaltyLimit() const;

 private:
  Simplex(int n, int m);
  bool Refresh();
  // The first point that ReplaceByGeometryPoint() tries. Equal to the pole if the bounds permit no
  // step.
  Eigen::VectorXd GeometryPoint(int j, double length, double penalty,
                                const Evaluator& evaluator) const;

  Eigen::MatrixXd vertices_;  // n × (n+1), the pole last
  Eigen::VectorXd values_, violations_;
  Eigen::MatrixXd constraints_;  // m × (n+1)
  Eigen::MatrixXd offsets_, inverse_;
  Eigen::VectorXd edge_lengths_, face_distances_;
  LinearInterpolant model_;
};

}  // namespace lacuna

#endif  // LACUNA_SEARCH_SIMPLEX_H_
