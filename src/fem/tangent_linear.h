// How a trajectory changes, to first order, with what it depends on: the tangent-linear model.
//
// Differentiating the equation of a step, r(x; x̃, ṽ, z, p) = 0 (step_equation.h; z: the memory of
// the effects), along a parameter p gives one linear system per step and parameter,
//   (∂r/∂x) s = M (γ² s̃ + γ w̃) − γ ∂f/∂v s̃ − ∂f/∂a (γ² s̃ + γ w̃) + ∂f/∂z ζ + ∂f/∂p,
// for s = dx/dp, with s̃, w̃ the combinations of earlier sensitivities that x̃, ṽ are of earlier
// states, and ζ = dz/dp. The matrix is that of Newton's method at the step's end; it is factorised
// once per step, for all parameters (direct differentiation: Tortorelli & Michaleris, Inverse
// Problems in Engineering 1, 1994).
//
// The parameter may belong to an effect that the model does not have: with the effect at its null
// value the result is how the motion would answer to a little of it. So all effects of a library
// are tried along one trajectory.
//
// Where a tangent is not symmetric (effect.h), its symmetric part is factorised, and what the
// skew-symmetric one leaves is solved again until it is little: forces that follow the body, or
// brake it, answer to a turn in full.
#ifndef LACUNA_FEM_TANGENT_LINEAR_H_
#define LACUNA_FEM_TANGENT_LINEAR_H_

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fem/model.h"
#include "fem/step_equation.h"

namespace lacuna {

// One thing that a trajectory depends on; its parts add.
struct Perturbation {
  // The force ∂f/∂(parameter) of this effect. If it is none of the model's, it must be at its null
  // value; its memory then follows the trajectory.
  std::shared_ptr<const Effect> effect = nullptr;
  int parameter = 0;
  // d(position)/dp of the gripped nodes at the end of a step (3n; other nodes are not read), where
  // the grips exert `reaction` on the body (3n, N; other nodes' entries mean nothing). Empty: 0.
  std::function<Eigen::VectorXd(double time, const Eigen::VectorXd& reaction)> grip = {};
  // d(external force)/dp in an equilibrium (3n, N per unit): of what holds the body before it is
  // let go. Empty: 0.
  Eigen::VectorXd held_force = {};
};

struct TangentLinearSummary {
  enum class Status { kNotRun, kSolved, kNotPositiveDefinite };
  Status status = Status::kNotRun;
  std::string message;
  bool IsUsable() const { return status == Status::kSolved; }
};

class TangentLinear {
 public:
  // All sensitivities are 0 at first.
  TangentLinear(const Model& model, std::vector<Perturbation> perturbations);
  ~TangentLinear();
  TangentLinear(TangentLinear&&) noexcept;
  TangentLinear& operator=(TangentLinear&&) noexcept;

  // After the step (or the equilibrium: kQuasiStatic, 0) from `before` to `position` was found. An
  // equilibrium forgets where it was sought from; what it leaves is a state at rest.
  TangentLinearSummary Advance(const MotionHistory& before, TimeScheme scheme, double time_step,
                               const Eigen::VectorXd& position);

  // dx/dp and dv/dp at the end of the last step (3n × perturbations).
  const Eigen::MatrixXd& position() const;
  const Eigen::MatrixXd& velocity() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_TANGENT_LINEAR_H_
