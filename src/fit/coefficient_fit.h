// The force fit with the positions eliminated: the balance holds exactly, for few coefficients.
#ifndef LACUNA_FIT_COEFFICIENT_FIT_H_
#define LACUNA_FIT_COEFFICIENT_FIT_H_

#include <Eigen/Core>
#include <memory>

#include "fem/model.h"
#include "fem/step_equation.h"
#include "fit/force_fit.h"
#include "fit/force_model.h"
#include "fit/observations.h"

namespace lacuna {

// Minimises over the coefficients alone
//
//   ½ Σ_j ρ(‖W_j (N_j x(c) − y_j)‖²) + ½ ‖c − c₀‖²        with        r(x(c)) = B c
//
// where y_j are the observations with interpolation N_j and whitening W_j (observations.h), ρ is
// Huber's loss and B the basis of the force model. The balance r(x) = B c is solved by Newton's
// method for each c; the derivative follows from the implicit function theorem,
// ∂x/∂c = (∂r/∂x)⁻¹ B, with one factorisation and one back-substitution per coefficient. Time and
// memory grow with coefficients × nodes.
class CoefficientFitter {
 public:
  // `position` (3n, m) and `coefficients` (K) are the start and must have their full sizes. The
  // force model must have no free nodes (CHECK). Model, equation and force model must outlive the
  // fitter.
  CoefficientFitter(const Model& model, const StepEquation& equation, const ForceModel& force_model,
                    const Eigen::VectorXd& position, const Eigen::VectorXd& coefficients);
  ~CoefficientFitter();

  // Starts from the result of the previous fit. `prior.coefficients` must have its full size. If
  // the search fails, the status is kNoConvergence and the message is that of Ceres.
  ForceFit Fit(const Observations& observations, const ForceFitPrior& prior,
               const ForceFitOptions& options);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lacuna

#endif  // LACUNA_FIT_COEFFICIENT_FIT_H_
