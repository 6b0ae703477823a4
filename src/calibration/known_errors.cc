#include "calibration/known_errors.h"

#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "analysis/linear_evidence.h"
#include "calibration/linear_misfit.h"
#include "calibration/mesh_limit.h"
#include "calibration/size_errors.h"

namespace lacuna {

KnownErrors FindKnownErrors(const CalibrationProblem& problem, const Eigen::VectorXd& values) {
  KnownErrors errors{{}, Eigen::VectorXd::Zero(values.size())};
  const std::vector<CalibratedParameter>& parameters = problem.parameters();
  const LinearisedMisfit misfit = problem.Linearise(values, true);
  if (!misfit.usable) return errors;
  const auto add = [&](const Eigen::VectorXd& change) {  // in the units of MovedBy
    for (Eigen::Index k = 0; k < values.size(); ++k) {
      const bool log_scale = parameters[static_cast<size_t>(k)].log_scale;
      errors.deviation[k] =
          std::hypot(errors.deviation[k], log_scale ? change[k] / values[k] : change[k]);
    }
  };
  if (const auto mesh = MakeOtherMesh(problem, values, misfit, /*fitted_only=*/true)) {
    errors.at_mesh_limit = MovedBy(parameters, values, mesh->ToLimit() * mesh->change);
    add(mesh->DeviationOfLimit() * mesh->change);
  }
  const Eigen::MatrixXd by_size = ChangesBySize(problem, values, misfit);
  if (by_size.cols() == 0) return errors;
  const Eigen::MatrixXd by_parameters =
      WhitenedRows(misfit.jacobian.leftCols(values.size()), misfit, 0, /*fitted_only=*/true);
  std::vector<LinearPrior> priors = PriorsAbout(parameters, values);
  for (LinearPrior& prior : priors) prior.mean = 0;  // only the response to the error counts
  const LinearGaussianModel model(Eigen::VectorXd::Zero(by_parameters.rows()), by_parameters,
                                  std::move(priors));
  std::vector<int> all(static_cast<size_t>(values.size()));
  std::iota(all.begin(), all.end(), 0);
  const Eigen::MatrixXd whitened = WhitenedRows(by_size, misfit, 0, /*fitted_only=*/true);
  for (Eigen::Index axis = 0; axis < whitened.cols(); ++axis)
    add(model.WithResidual(whitened.col(axis), by_parameters).Fit(all, 1).change);
  return errors;
}

}  // namespace lacuna
