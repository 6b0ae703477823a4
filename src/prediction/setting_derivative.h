// The derivative of a motion with respect to a parameter of an effect, also where it is a setting.
//
// A setting is never fitted, and effects do not differentiate their force f with respect to it
// (fem/effect.h). But a setting that follows the material, such as the Poisson's ratio of a
// viscoelastic branch, changes with a parameter that is fitted (ModelParameters in
// prediction/prediction_study.h). Its derivative is the central difference
//   ∂f/∂p ≈ (f(x; z⁺, p + h) − f(x; z⁻, p − h))/(2h),
// where the internal variables z± follow the same motion x with p ± h, so that ∂f/∂z dz/dp is part
// of it.
#ifndef LACUNA_PREDICTION_SETTING_DERIVATIVE_H_
#define LACUNA_PREDICTION_SETTING_DERIVATIVE_H_

#include <memory>

#include "fem/tangent_linear.h"

namespace lacuna {

// The perturbation of the parameter of this number of an effect of the model. The value of a
// setting must lie inside its bounds (CHECKed).
Perturbation ParameterPerturbation(const std::shared_ptr<const Effect>& effect, int parameter);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_SETTING_DERIVATIVE_H_
