// The force fit with the positions eliminated: exact balance, for forces of few coefficients.
#ifndef LACUNA_FIT_COEFFICIENT_FIT_H_
#define LACUNA_FIT_COEFFICIENT_FIT_H_

#include "fit/force_fit.h"

namespace lacuna {

// Minimises over the coefficients alone
//
//   ½ Σ_j ρ(‖W_j (N_j x(c) − y_j)‖²) + ½ ‖c − c₀‖²        with        r(x(c)) = B c
//
// solved by Newton's method at each c; the derivative comes from the implicit function theorem,
// ∂x/∂c = (∂r/∂x)⁻¹ B, one back-substitution per coefficient with one factor. Cost and memory grow
// with coefficients × nodes. The force model must have no free nodes.
class CoefficientFitter {
 public:
  // Sizes are full here: `position` 3n, `coefficients` K.
  CoefficientFitter(const Model& model, const StepEquation& equation, const ForceModel& force_model,
                    const Eigen::VectorXd& position, const Eigen::VectorXd& coefficients);
  ~CoefficientFitter();

  // From where the last fit ended.
  ForceFit Fit(const Observations& observations, const ForceFitPrior& prior,
               const ForceFitOptions& options);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lacuna

#endif  // LACUNA_FIT_COEFFICIENT_FIT_H_
