#include "calibration/step_errors.h"

#include <algorithm>
#include <cmath>

#include "calibration/side_by_side.h"

namespace lacuna {
namespace {

// The factor p.
double ChangePerHalving(TimeScheme scheme, const Eigen::VectorXd& whole,
                        const Eigen::VectorXd& half, const Eigen::VectorXd& quarter) {
  constexpr double kSecondOrder = 4;
  const double least = std::exp2(OrderOf(scheme));
  const double along = (half - whole).dot(quarter - half);
  if (!(along > 0)) return least;
  return std::clamp((half - whole).squaredNorm() / along, least, kSecondOrder);
}

}  // namespace

std::optional<StepErrors> FindStepErrors(const CalibrationProblem& problem,
                                         const Eigen::VectorXd& values,
                                         const LinearisedMisfit& misfit) {
  const auto with_steps = [&](double ratio) {
    PredictionStudy study = problem.WithEstimatedNoise();
    study.time_step /= ratio;
    return CalibrationProblem(study, problem.body()->mesh)
        .Linearise(values, false, {}, nullptr, &misfit)
        .residual;
  };
  const Eigen::VectorXd& whole = misfit.residual;
  Eigen::VectorXd half, quarter;
  ForEachStudy(problem, 2,
               [&](int64_t k) { k == 0 ? quarter = with_steps(4) : half = with_steps(2); });
  if (half.size() != whole.size() || quarter.size() != half.size()) return std::nullopt;
  const double power = ChangePerHalving(problem.study().scheme, whole, half, quarter);
  return StepErrors{quarter + (quarter - half) / (power - 1) - whole,
                    (quarter - half) - (half - whole) / power};
}

}  // namespace lacuna
