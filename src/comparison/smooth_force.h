// A body force that is smooth in space and time, on the part of a body that no grip holds:
//   g(X, t) = ρ Σ_c a_c(t) ψ_c(X),
// ψ = 1 and the coordinate along the longest principal axis of the mass (mean 0, variance 1), a_c
// (m/s², three components each) linear in time between evenly spaced knots. Its net force is that
// of ψ = 1.
#ifndef LACUNA_COMPARISON_SMOOTH_FORCE_H_
#define LACUNA_COMPARISON_SMOOTH_FORCE_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "fem/model.h"

namespace lacuna {

struct SmoothForce {
  static constexpr int kModes = 2;
  static constexpr int kShapes = 3 * kModes;  // x, y, z of the first mode, of the second, …

  Eigen::MatrixXd modes;       // n × 2: ψ at the nodes, 0 where a grip holds
  Eigen::VectorXd node_mass;   // kg
  double density = 0;          // ρ, kg/m³
  double start = 0;            // s, of the first knot; before it the force is as there
  double spacing = 1;          // s
  Eigen::MatrixXd amplitudes;  // 6 × knots (at least 2), m/s²

  int KnotCount() const { return static_cast<int>(amplitudes.cols()); }
  // The two knots around a time: weight `next` of knot + 1, 1 − next of knot.
  struct Between {
    int knot;
    double next;
  };
  Between At(double time) const;
  Eigen::VectorXd AmplitudesAt(double time) const;
  // g at the nodes, 3 × n, N/m³.
  Eigen::Matrix3Xd DensityAt(double time) const;
  // Nodal forces of unit amplitudes, 3n × 6, N per m/s².
  Eigen::MatrixXd Shapes() const;
  // The force as effects of a model; refers to nothing of this.
  EffectList Effects() const;
};

// Without force, with `knots` knots from `start` to `end`.
SmoothForce MakeSmoothForce(const Model& model, double start, double end, int knots);

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_SMOOTH_FORCE_H_
