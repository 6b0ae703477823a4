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
// ∂x/∂c = (∂r/∂x)⁻¹ B, one back-substitution per coefficient with the factor that Newton's method
// ends with. Cost and memory grow with coefficients × nodes.
//
// The force model must have no free nodes; `start` and `prior` must have their full sizes.
ForceFit FitCoefficients(const Model& model, const StepEquation& equation,
                         const ForceModel& force_model, const Observations& observations,
                         const ForceFitStart& start, const ForceFitPrior& prior,
                         const ForceFitOptions& options);

}  // namespace lacuna

#endif  // LACUNA_FIT_COEFFICIENT_FIT_H_
