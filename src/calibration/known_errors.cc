#include "calibration/known_errors.h"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "calibration/in_phase.h"
#include "calibration/linear_misfit.h"
#include "calibration/mesh_limit.h"
#include "calibration/size_errors.h"
#include "calibration/step_errors.h"
#include "core/parallel.h"

namespace lacuna {

KnownErrors FindKnownErrors(const CalibrationProblem& problem, const Eigen::VectorXd& values) {
  KnownErrors errors{{}, values, Eigen::VectorXd::Zero(values.size())};
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
  const Eigen::MatrixXd jacobian = misfit.jacobian.leftCols(values.size());
  // The change of the parameters by which the fit would compensate for a change of the residual, m.
  const auto response = [&](const Eigen::MatrixXd& change) -> Eigen::VectorXd {
    return KeptInPhase(change, problem, values, misfit, /*fitted_only=*/true).parameters.col(0);
  };
  std::optional<OtherMesh> mesh;
  std::optional<StepErrors> step;
  Eigen::MatrixXd by_size;
  ParallelFor(3, 1, [&](int64_t k) {
    if (k == 0) mesh = MakeOtherMesh(problem, values, misfit, /*fitted_only=*/true);
    if (k == 1) step = FindStepErrors(problem, values, misfit);
    if (k == 2) by_size = ChangesBySize(problem, values, misfit);
  });
  Eigen::VectorXd to_limit = Eigen::VectorXd::Zero(values.size());
  if (mesh) {
    // `mesh` was compared with other parameters, chosen under a narrower prior than that of the
    // fit.
    const Eigen::VectorXd change = response(mesh->other - mesh->own - jacobian * mesh->change);
    to_limit = mesh->ToLimit() * change;
    errors.at_mesh_limit = MovedBy(parameters, values, to_limit);
    add(mesh->DeviationOfLimit() * change);
  }
  if (step) {
    const Eigen::VectorXd change = response(step->to_limit);
    to_limit += change;
    add(StepErrors::kLimitDeviation * change);
    add(StepErrors::kDepartureDeviation * response(step->departure));
  }
  errors.at_limit = MovedBy(parameters, values, to_limit);
  for (Eigen::Index axis = 0; axis < by_size.cols(); ++axis) add(response(by_size.col(axis)));
  return errors;
}

}  // namespace lacuna
