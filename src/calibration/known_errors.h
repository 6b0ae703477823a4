// Errors of a fitted model that its fit does not estimate: the size of its elements, the
// length of its time step, and the dimensions of the object. They move the fitted parameters, so
// that an interval of the noise alone would be too narrow and in the wrong place.
//
// To first order, an error that changes the whitened residual by c moves the parameters by
//   δ = −(JᵀJ + P⁻¹)⁻¹ Jᵀ c,
// with their Jacobian J and prior covariance P: the fit compensates for as much of c as it can. An
// error whose size is known in distribution only adds δ δᵀ for each standard deviation to the
// covariance of the parameters ("consider" parameters: Schmidt, Advances in Control Systems 3,
// 1966).
#ifndef LACUNA_CALIBRATION_KNOWN_ERRORS_H_
#define LACUNA_CALIBRATION_KNOWN_ERRORS_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "calibration/mesh_limit.h"
#include "core/progress.h"

namespace lacuna {

// What is known about the errors of fitted values; vectors are in the order of
// CalibrationProblem::parameters().
struct KnownErrors {
  // The values that would have been fitted with infinitely fine elements; empty where no other mesh
  // can be made or simulated (calibration/mesh_limit.h).
  Eigen::VectorXd at_mesh_limit;
  std::optional<OtherMesh> other_mesh;  // from which they were extrapolated
  // The values that would have been fitted with infinitely fine elements, as far as these are
  // known, and infinitely short time steps.
  Eigen::VectorXd at_limit;
  // Standard deviations by which unknown parts of the errors move the parameters, on the scale on
  // which each is fitted: of the extrapolations to infinitely fine elements and short steps, and of
  // the dimensions (PredictionStudy::size_deviation).
  Eigen::VectorXd deviation;
  // The errors that could not be computed, so that `at_limit` and `deviation` do not contain them.
  std::vector<std::string> notes;
};

// `values`: the fitted ones. Reports the frames that have been predicted to the current stage of
// `progress`; how many there will be is not known in advance. Throws Interrupted.
KnownErrors FindKnownErrors(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                            Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_KNOWN_ERRORS_H_
