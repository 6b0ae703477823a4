// Changes of a motion that the parameters do not follow.
#ifndef LACUNA_CALIBRATION_IN_PHASE_H_
#define LACUNA_CALIBRATION_IN_PHASE_H_

#include <Eigen/Core>

#include "calibration/calibration_problem.h"

namespace lacuna {

// A longer object vibrates more slowly. The change c of its residual therefore grows with time and
// cannot be multiplied by an amount once the phase has moved by more than a small part of a
// period; nor can it be added to a motion whose moduli were fitted to another frequency. Together
// with the change g of the parameters that keeps the motion in phase,
//   g = argmin ‖c + J g‖² + Σ (g/s)²,
// it stays small, where c and the Jacobian J are whitened and s are the deviations of the
// parameters' priors. The sum c + J g spans the same space beside J as c does.
struct InPhase {
  Eigen::MatrixXd change;      // g, one column for each of `columns`, in the units of MovedBy()
  Eigen::MatrixXd of_columns;  // c + J g, m
};

// `columns`: changes of the rows of `misfit`, m, for amounts that are typical. `misfit` is that at
// `values`, with the Jacobian of the problem's parameters in its first columns.
InPhase KeptInPhase(const Eigen::MatrixXd& columns, const CalibrationProblem& problem,
                    const Eigen::VectorXd& values, const LinearisedMisfit& misfit);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_IN_PHASE_H_
