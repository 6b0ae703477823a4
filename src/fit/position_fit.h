// The force fit with all positions as unknowns: sparse however many nodes carry a force.
#ifndef LACUNA_FIT_POSITION_FIT_H_
#define LACUNA_FIT_POSITION_FIT_H_

#include "fit/force_fit.h"

namespace lacuna {

// Minimises over positions x and coefficients c
//
//   ½ Σ_j ρ(‖W_j (N_j x − y_j)‖²) + ½ Σ_i ‖(r_i(x) − g_i − B_i c)/s_i‖² + ½ ‖c − c₀‖²
//
// with r(x) the equation of motion of the step: the outer force that the motion x takes. At a free
// node g_i is the prior force and s_i the scale of the force prior. At the others s_i is a tight
// tolerance and −g_i the multiplier of an augmented Lagrangian (Nocedal & Wright 2006, ch. 17):
// without it the body would lean on many small imbalances, which a slender body amplifies.
// Row i of the Jacobian holds only the nodes that share an element with node i.
//
// All of `start` and `prior` must have their full sizes.
struct PositionFitStart {
  Eigen::VectorXd position;      // 3n, m; gripped nodes where their grip puts them
  Eigen::VectorXd coefficients;  // K
  Eigen::VectorXd multiplier;    // 3n, N: that of an earlier fit of the same step, or 0
};
ForceFit FitPositions(const Model& model, const StepEquation& equation,
                      const ForceModel& force_model, const Observations& observations,
                      const PositionFitStart& start, const ForceFitPrior& prior,
                      const ForceFitOptions& options);

}  // namespace lacuna

#endif  // LACUNA_FIT_POSITION_FIT_H_
