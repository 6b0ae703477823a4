// The force fit with all positions as unknowns: a sparse problem for any number of forces.
#ifndef LACUNA_FIT_POSITION_FIT_H_
#define LACUNA_FIT_POSITION_FIT_H_

#include <Eigen/Core>

#include "fem/model.h"
#include "fem/step_equation.h"
#include "fit/force_fit.h"
#include "fit/force_model.h"
#include "fit/observations.h"

namespace lacuna {

// Minimises over positions x and coefficients c
//
//   ½ Σ_j ρ(‖W_j (N_j x − y_j)‖²) + ½ Σ_i ‖(r_i(x) − g_i − B_i c)/s_i‖² + ½ ‖c − c₀‖²
//
// where y_j are the observations with interpolation N_j and whitening W_j (observations.h), ρ is
// Huber's loss, r(x) the residual of the equation of motion (the external force that the motion x
// requires) and B the basis of the force model. At a free node g_i is the prior force and s_i the
// scale of the force prior. At all other nodes s_i is a tight tolerance and −g_i the multiplier of
// an augmented Lagrangian (Nocedal & Wright 2006, ch. 17): without it, many small imbalances would
// add up to a spurious load, which a slender body amplifies. Row i of the Jacobian involves only
// the nodes that share an element with node i.
struct PositionFitStart {
  Eigen::VectorXd position;      // 3n, m; gripped nodes at the positions of their grip
  Eigen::VectorXd coefficients;  // K
  Eigen::VectorXd multiplier;    // 3n, N: from an earlier fit of the same step, or 0
};

// All vectors of `start` and `prior` must have their full sizes. If Ceres finds no usable solution,
// the result has the status kNoConvergence and its message. Throws Interrupted after an interrupt.
ForceFit FitPositions(const Model& model, const StepEquation& equation,
                      const ForceModel& force_model, const Observations& observations,
                      const PositionFitStart& start, const ForceFitPrior& prior,
                      const ForceFitOptions& options);

}  // namespace lacuna

#endif  // LACUNA_FIT_POSITION_FIT_H_
