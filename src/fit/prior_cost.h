// The cost that a fit minimises, with the priors of its parameters:
//   C(φ) = ½ ‖r‖² + ½ Σ ((φₖ − φ̄ₖ)/sₖ)²,
// where φ are the free values (calibrated_parameter.h), φ̄ the means and s the deviations of their
// priors. Parameters without a prior have no term.
#ifndef LACUNA_FIT_PRIOR_COST_H_
#define LACUNA_FIT_PRIOR_COST_H_

#include <Eigen/Core>
#include <vector>

#include "fit/active_bounds.h"
#include "fit/calibrated_parameter.h"

namespace lacuna {

// (φ − φ̄)/s of a value θ, SI; 0 without a prior.
double FromPriorMean(const CalibratedParameter& parameter, double value);

// C at the values θ (SI, one for each parameter), where the residual is r.
double CostAt(const std::vector<CalibratedParameter>& parameters, const Eigen::VectorXd& values,
              const Eigen::VectorXd& residual);

// Turns the derivatives ∂r/∂θ at these values, a column for each parameter, into ∂r/∂φ.
void DeriveByFreeValues(const std::vector<CalibratedParameter>& parameters,
                        const Eigen::VectorXd& values, Eigen::MatrixXd* columns);

// C about these values as a quadratic function of a step of φ. `columns`: ∂r/∂φ.
QuadraticCost CostAbout(const std::vector<CalibratedParameter>& parameters,
                        const Eigen::VectorXd& values, const Eigen::VectorXd& residual,
                        const Eigen::MatrixXd& columns);

}  // namespace lacuna

#endif  // LACUNA_FIT_PRIOR_COST_H_
