// How the parameters follow a change of the motion.
#ifndef LACUNA_CALIBRATION_PARAMETER_RESPONSE_H_
#define LACUNA_CALIBRATION_PARAMETER_RESPONSE_H_

#include <Eigen/Core>

#include "analysis/linear_evidence.h"
#include "calibration/calibration_problem.h"

namespace lacuna {

// The change g of the parameters by which a fit compensates for a change c of the residual,
//   g = argmin ‖c + J g‖² + Σ (g/s)²,
// where c and the Jacobian J are whitened and s are the deviations of the parameters' priors.
class ParameterResponse {
 public:
  // `misfit` is that at `values`, with the Jacobian of the problem's parameters in its first
  // columns, and must outlive this. `fitted_only`: c counts in the fitted frames only.
  ParameterResponse(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                    const LinearisedMisfit& misfit, bool fitted_only);

  // g for each column of `changes` (rows of the misfit, m), in the units of MovedBy().
  Eigen::MatrixXd To(const Eigen::MatrixXd& changes) const;

  // c + J g for each column, m. With other dimensions, an object vibrates at another frequency, so
  // that c grows with time and is proportional to the amount only while the phase error is a small
  // part of a period. The sum is the change of a motion that is kept in phase, and stays small.
  // Beside J it spans the same space as c; the evidence is the same only where the priors are wide.
  Eigen::MatrixXd InPhase(const Eigen::MatrixXd& changes) const;

 private:
  const LinearisedMisfit& misfit_;
  const bool fitted_only_;
  Eigen::MatrixXd by_;  // J, whitened
  LinearGaussianModel model_;
};

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_PARAMETER_RESPONSE_H_
