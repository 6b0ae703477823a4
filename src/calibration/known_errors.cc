#include "calibration/known_errors.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "calibration/linear_misfit.h"
#include "calibration/parameter_response.h"
#include "calibration/side_by_side.h"
#include "calibration/size_errors.h"
#include "calibration/step_errors.h"

namespace lacuna {

KnownErrors FindKnownErrors(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                            Progress* progress) {
  const std::function<void()> on_frame = StageCounter(progress);
  KnownErrors errors;
  errors.at_limit = values;
  errors.deviation = Eigen::VectorXd::Zero(values.size());
  const std::vector<CalibratedParameter>& parameters = problem.parameters();
  const LinearisedMisfit misfit =
      problem.Linearise(values, {.with_jacobian = true, .on_frame = on_frame});
  if (!misfit.usable) {
    errors.notes.push_back(
        "the intervals do not contain the errors of the mesh, of the time step and of the object's "
        "dimensions: the fitted motion could not be predicted again (" +
        misfit.message + ")");
    return errors;
  }
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
  ForEachStudy(problem, 3, [&](int64_t k) {
    if (k == 0) mesh = MakeOtherMesh(problem, values, misfit, /*known=*/nullptr, on_frame);
    if (k == 1) step = FindStepErrors(problem, values, misfit, on_frame);
    if (k == 2) by_size = ChangesBySize(problem, values, misfit, on_frame);
  });
  Eigen::VectorXd to_limit = Eigen::VectorXd::Zero(values.size());
  if (mesh) {
    // `mesh` was compared with other parameters, chosen under a narrower prior than that of the
    // fit.
    const Eigen::VectorXd change = response.To(mesh->other - mesh->own - jacobian * mesh->change);
    to_limit = mesh->ToLimit() * change;
    errors.at_mesh_limit = MovedBy(parameters, values, to_limit);
    add(mesh->DeviationOfLimit() * change);
    errors.other_mesh = std::move(mesh);
  } else {
    errors.notes.emplace_back(
        "the intervals do not contain the error of the mesh: no other mesh could be made, or the "
        "motion could not be predicted on it");
  }
  if (step) {
    const Eigen::VectorXd change = response.To(step->to_limit);
    to_limit += change;
    add(StepErrors::kLimitDeviation * change);
    add(StepErrors::kDepartureDeviation * response.To(step->departure));
  } else {
    errors.notes.emplace_back(
        "the intervals do not contain the error of the time step: the motion could not be "
        "predicted with a shorter one");
  }
  errors.at_limit = MovedBy(parameters, values, to_limit);
  if (by_size.cols() > 0) {
    const Eigen::MatrixXd by_sizes = response.To(by_size);
    for (const auto change : by_sizes.colwise()) add(change);
  } else if (problem.study().size_deviation > 0) {
    errors.notes.emplace_back(
        "the intervals do not contain the uncertainty of the object's dimensions (size_deviation): "
        "the motion of a larger object could not be predicted");
  }
  return errors;
}

}  // namespace lacuna
