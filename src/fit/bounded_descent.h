// The minimiser of a calibration: least squares with priors and bounds.
//
// Levenberg–Marquardt steps (Marquardt, SIAM J. Appl. Math. 11, 1963) within the bounds: each step
// minimises the quadratic model of the cost, damped in proportion to the diagonal of the
// information matrix, over the box that the bounds leave (bounded_steps.h). Parameters therefore
// reach their bounds, stay on them and leave them without a change of variables. The damping is the
// least that keeps a step within a trust region, which is unlimited until the first step that does
// not reduce the cost (Moré, Lect. Notes Math. 630, 1978). A refused step reveals the curvature of
// the valley, which the next one follows (geodesic acceleration: Transtrum & Sethna,
// arXiv:1201.5885, 2012).
//
// A prediction costs much more than a step, and its derivatives several times as much as the
// prediction. Steps are therefore predicted without derivatives, and secants (Broyden, Math.
// Comput. 19, 1965) take their place as long as the steps gain what is predicted. Where one does
// not, and where the search seems to be at its end, the derivatives are computed: the search never
// ends on secants.
#ifndef LACUNA_FIT_BOUNDED_DESCENT_H_
#define LACUNA_FIT_BOUNDED_DESCENT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fit/calibrated_parameter.h"
#include "fit/calibration_options.h"
#include "fit/residual_function.h"

namespace lacuna {

struct DescentEnd {
  Eigen::VectorXd parameters;     // θ, SI, within the bounds; the best that was found
  ResidualEvaluation prediction;  // at these parameters, with its Jacobian
  bool usable = false;            // whether the search has converged
  std::string message;            // why it has not
  double cost = 0;                // ½ ‖r‖² and the priors there
  int iterations = 0;             // steps that were tried
  int predictions = 0;            // evaluations of the residual function
  // CalibrationOptions::max_predictions or max_iterations has ended it.
  bool is_out_of_budget = false;
};

// Searches from the starts of the parameters, of which there must be at least one. `first` is the
// prediction at the starts; it must be usable and have its Jacobian.
DescentEnd Descend(const std::vector<CalibratedParameter>& parameters,
                   const CalibrationOptions& options, ResidualEvaluation first,
                   const ResidualFunction& predict);

}  // namespace lacuna

#endif  // LACUNA_FIT_BOUNDED_DESCENT_H_
