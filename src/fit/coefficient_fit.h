// The force fit with the positions eliminated: the balance holds exactly, for few coefficients.
#ifndef LACUNA_FIT_COEFFICIENT_FIT_H_
#define LACUNA_FIT_COEFFICIENT_FIT_H_

#include <Eigen/Core>
#include <memory>

#include "fem/model.h"
#include "fem/step_equation.h"
#include "fit/balance_control.h"
#include "fit/force_fit.h"
#include "fit/force_model.h"
#include "fit/observations.h"

namespace lacuna {

// Minimises over K unknowns u
//
//   ½ Σ_j ρ(‖W_j (N_j x(u) − y_j)‖²) + ½ ‖c(u) − c₀‖²        with        r(x(u)) = B c(u)
//
// where y_j are the observations with interpolation N_j and whitening W_j (observations.h), ρ is
// Huber's loss and B the basis of the force model. The unknowns are the coefficients c themselves
// or the places of the loaded nodes (balance_control.h). The balance is solved by Newton's method
// for each u; the derivatives follow from the implicit function theorem, with one factorisation and
// one back-substitution per unknown. Time and memory grow with unknowns × nodes.
class CoefficientFitter {
 public:
  // `position` (3n, m) and `coefficients` (K) are the start and must have their full sizes. The
  // force model must have no free nodes (CHECK). Model, equation and force model must outlive the
  // fitter.
  CoefficientFitter(const Model& model, const StepEquation& equation, const ForceModel& force_model,
                    std::unique_ptr<BalanceControl> control, const Eigen::VectorXd& position,
                    const Eigen::VectorXd& coefficients);
  ~CoefficientFitter();

  // Starts from the result of the previous fit. `prior.coefficients` must have its full size. If
  // the search fails, the status is kNoConvergence and the message is that of Ceres. Throws
  // Interrupted after an interrupt.
  ForceFit Fit(const Observations& observations, const ForceFitPrior& prior,
               const ForceFitOptions& options);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lacuna

#endif  // LACUNA_FIT_COEFFICIENT_FIT_H_
