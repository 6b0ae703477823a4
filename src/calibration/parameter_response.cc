#include "calibration/parameter_response.h"

#include "calibration/linear_misfit.h"

namespace lacuna {
namespace {

// A response is to a change alone, whatever the distance of the values from their priors' means.
std::vector<LinearPrior> PriorsOfResponse(const CalibrationProblem& problem,
                                          const Eigen::VectorXd& values) {
  std::vector<LinearPrior> priors = PriorsAbout(problem.parameters(), values);
  for (LinearPrior& prior : priors) prior.mean = 0;
  return priors;
}

}  // namespace

ParameterResponse::ParameterResponse(const CalibrationProblem& problem,
                                     const Eigen::VectorXd& values, const LinearisedMisfit& misfit,
                                     bool fitted_only)
    : misfit_(misfit),
      fitted_only_(fitted_only),
      by_(WhitenedRows(misfit.jacobian.leftCols(values.size()), misfit,
                       {.fitted_only = fitted_only})),
      model_(Eigen::VectorXd::Zero(by_.rows()), by_, PriorsOfResponse(problem, values)) {}

Eigen::MatrixXd ParameterResponse::To(const Eigen::MatrixXd& changes) const {
  const Eigen::MatrixXd whitened = WhitenedRows(changes, misfit_, {.fitted_only = fitted_only_});
  Eigen::MatrixXd response(by_.cols(), changes.cols());
  for (Eigen::Index k = 0; k < changes.cols(); ++k)
    response.col(k) = model_.WithResidual(whitened.col(k), by_).FitAll(1).change;
  return response;
}

Eigen::MatrixXd ParameterResponse::InPhase(const Eigen::MatrixXd& changes) const {
  return changes + misfit_.jacobian.leftCols(by_.cols()) * To(changes);
}

}  // namespace lacuna
