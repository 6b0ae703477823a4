// What is prescribed where the force fit eliminates the positions of a step (coefficient_fit.h).
//
// In balance the positions x follow from K unknowns u. Either u are the coefficients of the forces
// themselves, or, where each coefficient is a force on one component of one node, u are the places
// of these components and the forces follow as their reactions. The second choice is the better
// conditioned one for large deformations: the balance then minimises the energy of a body whose
// loaded nodes are held, which a far step cannot make unstable, whereas under dead loads a soft
// body may snap through, so that x jumps as a function of the forces.
#ifndef LACUNA_FIT_BALANCE_CONTROL_H_
#define LACUNA_FIT_BALANCE_CONTROL_H_

#include <Eigen/Core>
#include <memory>
#include <utility>

#include "fem/block_matrix.h"
#include "fem/held_components.h"
#include "fem/linear_solver.h"
#include "fem/model.h"
#include "fem/step_equation.h"
#include "fit/force_model.h"

namespace lacuna {

// The derivatives of a balance with respect to the unknowns.
struct BalanceDerivative {
  Eigen::MatrixXd position;      // 3n × K: ∂x/∂u
  Eigen::MatrixXd coefficients;  // K × K: ∂c/∂u
  bool is_usable = false;        // false where the linear solver fails
};

class BalanceControl {
 public:
  explicit BalanceControl(HeldComponents held) : held_(std::move(held)) {}
  virtual ~BalanceControl() = default;

  const HeldComponents& held() const { return held_; }

  // The unknowns at a position (3n, m) under forces of the given coefficients (K).
  virtual Eigen::VectorXd Unknowns(const Eigen::VectorXd& position,
                                   const Eigen::VectorXd& coefficients) const = 0;
  // The force that is applied (3n, N) for the unknowns u (K).
  virtual Eigen::VectorXd Force(const Eigen::VectorXd& unknowns) const = 0;
  // Sets those components of `position` (3n, m) that u prescribes.
  virtual void Place(const Eigen::VectorXd& unknowns, Eigen::VectorXd* position) const = 0;
  // The coefficients c (K) at a balanced position.
  virtual Eigen::VectorXd Coefficients(const Eigen::VectorXd& unknowns,
                                       const Eigen::VectorXd& position) const = 0;
  // The derivatives at a balanced position, where `tangent` is the exact ∂r/∂x. `solver` holds the
  // components of held().
  virtual BalanceDerivative Differentiate(const BlockMatrix& tangent,
                                          LinearSolver* solver) const = 0;

 private:
  HeldComponents held_;
};

// u are the coefficients of the forces. The references must outlive the control.
std::unique_ptr<BalanceControl> ControlForces(const Model& model, const ForceModel& force_model);

// u are the places of the loaded components in metres. Null where the force model has a coefficient
// that is not a force on one free component of one node, or two for the same component.
std::unique_ptr<BalanceControl> ControlPlaces(const Model& model, const StepEquation& equation,
                                              const ForceModel& force_model);

}  // namespace lacuna

#endif  // LACUNA_FIT_BALANCE_CONTROL_H_
