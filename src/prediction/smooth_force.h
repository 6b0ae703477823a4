// A body force that is smooth in space and time, on the part of a body that no grip holds:
//   g(X, t) = ρ Σ_c a_c(t) ψ_c(X)
// with ψ_0 = 1 and ψ_1 the coordinate along the longest principal axis of the mass, scaled to mean
// 0 and variance 1. The amplitudes a_c (m/s², three components each) are linear in time between
// evenly spaced knots. The net force is that of ψ_0.
#ifndef LACUNA_PREDICTION_SMOOTH_FORCE_H_
#define LACUNA_PREDICTION_SMOOTH_FORCE_H_

#include <Eigen/Core>

#include "fem/model.h"

namespace lacuna {

struct SmoothForce {
  static constexpr int kModes = 2;
  static constexpr int kShapes = 3 * kModes;  // x, y, z of ψ_0, then of ψ_1

  Eigen::MatrixXd modes;       // n × 2: ψ at the nodes, 0 where a grip holds
  Eigen::VectorXd node_mass;   // n, kg
  double density = 0;          // ρ, kg/m³
  double start = 0;            // s, time of the first knot; before it the force is constant
  double spacing = 1;          // s, between knots
  Eigen::MatrixXd amplitudes;  // 6 × knots (at least 2), m/s²

  int KnotCount() const { return static_cast<int>(amplitudes.cols()); }
  // The weights of the knots at a time between two knots: 1 − next for `knot`, and `next` for the
  // one after it.
  struct KnotWeight {
    int knot;
    double next;
  };
  KnotWeight At(double time) const;
  // The amplitudes at a time, 6 × 1, m/s².
  Eigen::VectorXd AmplitudesAt(double time) const;
  // The force density g at the nodes, 3 × n, N/m³.
  Eigen::Matrix3Xd DensityAt(double time) const;
  // Nodal forces per unit of each amplitude, 3n × 6, N/(m/s²).
  Eigen::MatrixXd Shapes() const;
  // The force as effects of a model, which hold a copy of this force.
  EffectList Effects() const;
};

// A force of zero with `knots` (≥ 2, CHECK) knots from `start` to `end` (s, later than the start).
SmoothForce MakeSmoothForce(const Model& model, double start, double end, int knots);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_SMOOTH_FORCE_H_
