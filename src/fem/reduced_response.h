// How a trajectory answers to small forces over all of its time, in few shapes: the tangent-linear
// model (tangent_linear.h) projected onto a basis Φ, δx = Φ q,
//   Φᵀ(M + A)Φ q̈ + ΦᵀCΦ q̇ + ΦᵀKΦ q = Φᵀ δf,
// with K = −∂f/∂x, C = −∂f/∂v, A = −∂f/∂a of the effects at given states of the trajectory, linear
// in time between them. Hundreds of force histories then cost less than the trajectory itself.
//
// Φ spans K⁻¹F and K⁻¹MK⁻¹F for the given force shapes F at a few of the states: the first two
// moments of the response about frequency 0 (Su & Craig, Journal of Guidance, Control, and Dynamics
// 14, 1991), so that slow forces are answered to exactly there.
//
// The memory of effects is taken as it is along the trajectory: that a change of the motion changes
// it too is left out, and a relaxing effect answers to a change with its stiffness over one
// `time_step`.
#ifndef LACUNA_FEM_REDUCED_RESPONSE_H_
#define LACUNA_FEM_REDUCED_RESPONSE_H_

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "fem/model.h"
#include "fem/step_equation.h"

namespace lacuna {

// A state that a trajectory went through.
struct TrajectoryState {
  double time = 0;                            // s
  Eigen::VectorXd position, velocity;         // 3n
  std::vector<Eigen::VectorXd> effect_state;  // one for each of the model's effects
};

struct ReducedResponseOptions {
  TimeScheme scheme = TimeScheme::kTwoStep;
  double time_step = 0.005;  // s; steps are those of a prediction (NextStep)
  int most_shapes = 40;      // in Φ; more: finer, slower by the square
  int basis_states = 6;      // of the trajectory, evenly spread, that Φ is made at
};

// Forces on a trajectory, in the columns of Φᵀ F's k shapes: `amplitude(time)` is k × columns, in
// units of each shape.
using ForceHistories = std::function<Eigen::MatrixXd(double time)>;

class ReducedResponse {
 public:
  // `states`: ascending times, the first at rest. `shapes`: 3n × k, N. The first state is the
  // equilibrium that the motion starts from. CHECKs that there are states and that the model has
  // inertia.
  ReducedResponse(const Model& model, const std::vector<TrajectoryState>& states,
                  const Eigen::MatrixXd& shapes, const ReducedResponseOptions& options = {});

  bool IsUsable() const { return message_.empty(); }
  const std::string& message() const { return message_; }  // why not
  const Eigen::MatrixXd& basis() const { return basis_; }  // 3n × r, ΦᵀMΦ = I

  // Visits q and q̇ (r × columns) at `times` (ascending). Until the first state's time the body is
  // in equilibrium with `held` (k × columns), the amplitudes there; from then on the histories act.
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
