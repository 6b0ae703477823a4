// A reduced-order model of the linear response of a trajectory to small forces.
//
// The tangent-linear model (tangent_linear.h) is projected onto a basis Φ of few shapes, δx = Φ q:
//   Φᵀ(M + A)Φ q̈ + ΦᵀCΦ q̇ + ΦᵀKΦ q = Φᵀ δf,
// with the symmetric parts K, C and A of −∂f/∂x, −∂f/∂v and −∂f/∂a of the effects
// (Effect::AddTangents) at given states of the trajectory, and linear interpolation in time between
// them. The skew-symmetric parts, such as those of loads that turn with the body, are neglected.
// The response to hundreds of force histories then costs less than the trajectory itself.
//
// Φ spans K⁻¹F and K⁻¹MK⁻¹F for given force shapes F at some of the states, i.e. the first two
// moments of the response about frequency 0 (Su & Craig, Journal of Guidance, Control, and Dynamics
// 14, 1991), so that the response to slow forces is exact at these states.
//
// Internal variables of effects are those of the trajectory. Their change with the motion is
// neglected, so that a relaxing effect responds with its stiffness over one `time_step`.
#ifndef LACUNA_FEM_REDUCED_RESPONSE_H_
#define LACUNA_FEM_REDUCED_RESPONSE_H_

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "fem/model.h"
#include "fem/step_equation.h"

namespace lacuna {

// A state of the trajectory.
struct TrajectoryState {
  double time = 0;                            // s
  Eigen::VectorXd position, velocity;         // 3n, m and m/s
  std::vector<Eigen::VectorXd> effect_state;  // internal variables of each effect of the model
};

struct ReducedResponseOptions {
  TimeScheme scheme = TimeScheme::kTwoStep;
  double time_step = 0.005;  // s; steps as in a prediction (NextStep)
  int most_shapes = 40;      // upper limit for Φ; the cost grows with its square
  int basis_states = 6;      // number of evenly spaced states from which Φ is made
};

// Amplitudes of the k force shapes as a function of time (s): a k × columns matrix, with one column
// per force history.
using ForceHistories = std::function<Eigen::MatrixXd(double time)>;

class ReducedResponse {
 public:
  // `states` are in temporal order; the first one is the equilibrium from which the motion starts,
  // and there must be at least one (CHECK). `shapes` holds the force shapes F (3n × k, N). If the
  // stiffness is not definite at any of the states, the result is not usable. The arguments are not
  // needed after the construction.
  ReducedResponse(const Model& model, const std::vector<TrajectoryState>& states,
                  const Eigen::MatrixXd& shapes, const ReducedResponseOptions& options = {});

  bool IsUsable() const { return message_.empty(); }
  const std::string& message() const { return message_; }  // why it is not usable
  const Eigen::MatrixXd& basis() const { return basis_; }  // 3n × r, ΦᵀMΦ = I

  // Visits q and q̇ (r × columns) at `times` (s, ascending). Until the time of the first state the
  // body is in equilibrium with the constant amplitudes `held` (k × columns); after it the
  // histories act. CHECKs that the response is usable.
  void Respond(const Eigen::MatrixXd& held, const ForceHistories& histories,
               const std::vector<double>& times,
               const std::function<void(int index, const Eigen::MatrixXd& position,
                                        const Eigen::MatrixXd& velocity)>& visit) const;

 private:
  struct Tangents {
    double time = 0;
    Eigen::MatrixXd mass, damping, stiffness;  // r × r
  };
  Tangents At(double time) const;

  ReducedResponseOptions options_;
  std::string message_;
  Eigen::MatrixXd basis_, load_;  // load_: ΦᵀF
  std::vector<Tangents> tangents_;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_REDUCED_RESPONSE_H_
