#include "calibration/known_errors.h"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "calibration/linear_misfit.h"
#include "calibration/mesh_limit.h"
#include "calibration/parameter_response.h"
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
  const ParameterResponse response(problem, values, misfit, /*fitted_only=*/true);
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
    const Eigen::VectorXd change = response.To(mesh->other - mesh->own - jacobian * mesh->change);
    to_limit = mesh->ToLimit() * change;
    errors.at_mesh_limit = MovedBy(parameters, values, to_limit);
    add(mesh->DeviationOfLimit() * change);
  }
  if (step) {
    const Eigen::VectorXd change = response.To(step->to_limit);
    to_limit += change;
    add(StepErrors::kLimitDeviation * change);
    add(StepErrors::kDepartureDeviation * response.To(step->departure));
  }
  errors.at_limit = MovedBy(parameters, values, to_limit);
  const Eigen::MatrixXd by_sizes = response.To(by_size);
  for (const auto change : by_sizes.colwise()) add(change);
  return errors;
}

}  // namespace lacuna
