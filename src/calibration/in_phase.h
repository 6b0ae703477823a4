// Changes of a motion beside the parameters that keep it in phase.
#ifndef LACUNA_CALIBRATION_IN_PHASE_H_
#define LACUNA_CALIBRATION_IN_PHASE_H_

#include <Eigen/Core>

#include "calibration/calibration_problem.h"

namespace lacuna {

// With other dimensions, an object vibrates at another frequency, so that the change c of the
// residual grows with time. It is proportional to the amount only while the phase error is a small
// part of a period. Together with the change g of the parameters that keeps the motion in phase,
//   g = argmin ‖c + J g‖² + Σ (g/s)²,
// it stays small, where c and the Jacobian J are whitened and s are the deviations of the
// parameters' priors. Beside J, the sum c + J g spans the same space as c; the evidence is the same
// only where these priors are wide.
struct InPhase {
  Eigen::MatrixXd parameters;  // g, one column for each of `columns`, in the units of MovedBy()
  Eigen::MatrixXd residual;    // c + J g, m
};

// `columns`: changes of the rows of `misfit`, m, for amounts that are typical. `misfit` is that at
// `values`, with the Jacobian of the problem's parameters in its first columns. `fitted_only`: g is
// that of the fitted frames.
InPhase KeptInPhase(const Eigen::MatrixXd& columns, const CalibrationProblem& problem,
                    const Eigen::VectorXd& values, const LinearisedMisfit& misfit,
                    bool fitted_only);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_IN_PHASE_H_
