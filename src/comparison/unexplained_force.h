// Which force would have made a fitted model follow the markers: evidence on what it lacks.
//
// Sought are the amplitudes a of a smooth force (smooth_force.h), with the recording's own
// nuisances n (hold, clock), that minimise
//   ½ |r(a, n)|²/v + ½ aᵀ (s² L Lᵀ)⁻¹ a + ½ nᵀ P⁻¹ n,
// r whitened as in the fit; the fitted parameters stay. Gauss–Newton: the derivatives come from the
// projected tangent-linear model (fem/reduced_response.h) along the motion without the force, then
// along the one with it. The prior's width s and shape L, how even the force is over the object and
// how steady in time, and v are the data's choice (analysis/amplitude_estimate.h).
#ifndef LACUNA_COMPARISON_UNEXPLAINED_FORCE_H_
#define LACUNA_COMPARISON_UNEXPLAINED_FORCE_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "comparison/smooth_force.h"
#include "prediction/replayed_motion.h"

namespace lacuna {

// How the net force goes with the motion of the object's centre of mass.
struct ForceLikeness {
  std::string what;        // "displacement", "velocity" or "acceleration"
  double correlation = 0;  // of all components about their means in time, −1 to 1
};

struct UnexplainedForce {
  bool usable = false;
  std::string message;  // why not
  SmoothForce field;    // over model time: the recording's less the delay
  double delay = 0;     // s
  // One column for each state of the motion with the force.
  Eigen::VectorXd times;                      // s, of the recording
  Eigen::Matrix3Xd force, force_deviation;    // N, net
  Eigen::Matrix3Xd torque, torque_deviation;  // N m, about the centroid at rest
  Eigen::VectorXd power;                      // W, on the motion with the force
  Eigen::Matrix3Xd place;                     // m, at rest: the centroid of |g|
  // Over time, by components, N.
  Eigen::Vector3d rms = Eigen::Vector3d::Zero(), rms_deviation = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_force = Eigen::Vector3d::Zero(), mean_deviation = Eigen::Vector3d::Zero();
  double weight = 0;                                     // N, of the part that moves, for scale
  double constant_share = 0;                             // |mean| over the rms
  double work = 0, work_deviation = 0, mean_power = 0;   // J, J, W; > 0: it feeds the motion
  Eigen::Vector3d mean_place = Eigen::Vector3d::Zero();  // m, at rest, over time
  double grip_distance = 0, farthest = 0;  // m, of that place and of any node; 0: no grip
  std::vector<ForceLikeness> likeness;
  double in_noise_before = 0, in_noise_after = 0;  // rms of the whitened residual, replayed
  int predictions = 0;                             // that it took
  bool converged = false;  // the error along the motion with the force is what was expected of it
  double noise = 1;        // √v; the deviations hold it already
  double evidence = 0;     // ln of the likelihood with a force over that without, to first order
  // The evidence speaks for a force, and a component or its mean is beyond twice its own deviation
  // or the work beyond three times.
  bool stands_out = false;
};

// Knots: one for every frame of the motion, at most this many.
inline constexpr int kMostForceKnots = 60;

// Of a motion that was replayed to its end with the fitted model. `noise`, `place_deviation`: m, as
// the fit weighed.
UnexplainedForce EstimateUnexplainedForce(const RecordingModel& model, const ReplayedMotion& motion,
                                          double noise, double place_deviation);

// Fills what follows from the force and the covariance of its amplitudes (knots outermost), along
// the motion with the force.
void MeasureForce(const Model& model, const ReplayedMotion& motion,
                  const Eigen::MatrixXd& covariance, UnexplainedForce* force);

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_UNEXPLAINED_FORCE_H_
