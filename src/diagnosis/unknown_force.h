// The influence of an unknown smooth force on the measurements: whatever force, smooth in space and
// time, the model may lack.
//
// The force is that of prediction/smooth_force.h with the prior correlation exp(−|t − t'|/τ) of its
// amplitudes, τ = two frames. Its response follows from the reduced tangent-linear model along the
// fitted motion (fem/reduced_response.h). Of all force histories only those are kept whose response
// could be seen: the leading principal components of the whitened response under the prior.
#ifndef LACUNA_DIAGNOSIS_UNKNOWN_FORCE_H_
#define LACUNA_DIAGNOSIS_UNKNOWN_FORCE_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"

namespace lacuna {

struct UnknownForce {
  // One block of columns for each fitted recording, with the rows of the misfit, m: the response to
  // independent amplitudes whose prior standard deviation is 1 m/s².
  Eigen::MatrixXd columns;
  // The recordings without columns, each with the reason: too few frames of motion, a reduced model
  // that is not usable, or a force that could not be seen. Without any column, nothing tests
  // whether something unknown acts (AdequacyTest::p_unknown_force).
  std::vector<std::string> untried;
};

// `misfit` is that at `values`. Throws Interrupted.
UnknownForce UnknownForceColumns(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                                 const LinearisedMisfit& misfit);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_UNKNOWN_FORCE_H_
