// The tangent-linear model: first-order sensitivities of a trajectory to the parameters of its
// model.
//
// Differentiating the equation of a step, r(x; x̃, ṽ, z, p) = 0 (step_equation.h; z are the internal
// variables of the effects), with respect to a parameter p gives one linear system per step,
//   (∂r/∂x) s = M (γ² s̃ + γ w̃) − γ ∂f/∂v s̃ − ∂f/∂a (γ² s̃ + γ w̃) + ∂f/∂z ζ + ∂f/∂p,
// for s = dx/dp, where s̃ and w̃ combine earlier sensitivities as x̃ and ṽ combine earlier states, and
// ζ = dz/dp. The matrix is that of Newton's method at the end of the step. It is factorised once
// per step for all parameters (direct differentiation: Tortorelli & Michaleris, Inverse Problems in
// Engineering 1, 1994).
//
// The parameter may belong to an effect that the model does not contain. With this effect at its
// null value, the result is the response of the motion to a small amount of the effect, so that all
// effects of a catalogue can be tried along one trajectory.
//
// A tangent that is not symmetric or not definite is solved as tangent_solver.h describes.
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

// A parameter on which a trajectory depends. The contributions of its members are added.
struct Perturbation {
  // Contributes the force ∂f/∂p of a parameter of this effect. An effect that does not belong to
  // the model must be at its null value; its internal variables then follow the trajectory.
  std::shared_ptr<const Effect> effect = nullptr;
  int parameter = 0;
  // d(position)/dp of the gripped nodes at the end of a step (3n, m per unit), given the forces
  // that the grips exert on the body there (3n, N). Entries of other nodes are not used. Empty: 0.
  std::function<Eigen::VectorXd(double time, const Eigen::VectorXd& reaction)> grip = {};
  // d(external force)/dp in an equilibrium (3n, N per unit), for the force that holds the body
  // before it is released. Empty: 0.
  Eigen::VectorXd held_force = {};
};

struct TangentLinearSummary {
  enum class Status { kNotRun, kSolved, kSingular };
  Status status = Status::kNotRun;
  std::string message;
  bool IsUsable() const { return status == Status::kSolved; }
};

struct TangentLinearOptions {
  bool with_reactions = false;  // whether reaction() is computed, for a product with the tangent
                                // per step
  // The linear systems of models whose tangent is not symmetric are solved by iteration, to this
  // residual of each perturbation relative to its right-hand side. Larger values take fewer
  // iterations.
  double tolerance = 1e-7;
};

// Keeps a copy of the model, which shares body and effects, and of the perturbations. Not
// thread-safe: one object per simulation.
class TangentLinear {
 public:
  // All sensitivities are 0 at first.
  TangentLinear(const Model& model, std::vector<Perturbation> perturbations,
                const TangentLinearOptions& options = {});
  ~TangentLinear();
  TangentLinear(TangentLinear&&) noexcept;
  TangentLinear& operator=(TangentLinear&&) noexcept;

  // Advances the sensitivities over a step from `before` to `position` (3n, m) that a Stepper has
  // found; for an equilibrium the scheme is kQuasiStatic and the step length 0, and the start of
  // the search for it has no influence. If the tangent cannot be solved, the status is
  // kSingular and the sensitivities are those before the step.
  TangentLinearSummary Advance(const MotionHistory& before, TimeScheme scheme, double time_step,
                               const Eigen::VectorXd& position);

  // dx/dp and dv/dp at the end of the last step (3n × perturbations, m and m/s per unit).
  const Eigen::MatrixXd& position() const;
  const Eigen::MatrixXd& velocity() const;
  // dr/dp there (3n × perturbations, N per unit), less the derivative of an external force: at
  // gripped nodes that of the force by which the grip holds the node, at free nodes 0 up to the
  // accuracy of the solution. Zero before the first step, and where it is not computed.
  const Eigen::MatrixXd& reaction() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_TANGENT_LINEAR_H_
