// A body force that is smooth in space and time, on the part of a body that no grip holds:
//   g(X, t) = ρ Σ_c a_c(t) ψ_c(X)
// with ψ_0 = 1 and ψ_1 the coordinate along the longest principal axis of the mass, scaled to mean
// 0 and variance 1. The amplitudes a_c (m/s², three components each) are linear in time between
// evenly spaced knots. The net force is that of ψ_0.
#ifndef LACUNA_PREDICTION_SMOOTH_FORCE_H_
#define LACUNA_PREDICTION_SMOOTH_FORCE_H_

#include <Eigen/Core>
#include <optional>

#include "fem/model.h"
#include "prediction/replayed_motion.h"

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
  // The derivative of AmplitudesAt(time) by the amplitudes, column by column: 6 × 6·knots, the
  // weights of the knots as hat functions of time.
  Eigen::MatrixXd HatFunctions(double time) const;
  // The force density g at the nodes, 3 × n, N/m³.
  Eigen::Matrix3Xd DensityAt(double time) const;
  // Nodal forces per unit of each amplitude, 3n × 6, N/(m/s²).
  Eigen::MatrixXd Shapes() const;
  // The force as effects of a model, which hold a copy of this force.
  EffectList Effects() const;
};

// A force of zero over a replayed motion of a recording: a knot for each frame after the start, but
// not more than `most_knots`. Nothing where there are fewer than six such frames, too few to
// determine how a force changes with time.
std::optional<SmoothForce> SmoothForceDuring(const RecordingModel& recording,
                                             const ReplayedMotion& motion, int most_knots);

// A root L of a prior covariance of the amplitudes, column by column (6·knots square). L Lᵀ
// correlates the amplitudes of one shape at the knots i and j by exp(−|i − j| / persistence), and
// no others. Their standard deviation is 1 for ψ_0 and `deviation_of_mode` for ψ_1, m/s².
Eigen::MatrixXd PersistentPriorRoot(int knots, double persistence, double deviation_of_mode = 1);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_SMOOTH_FORCE_H_
