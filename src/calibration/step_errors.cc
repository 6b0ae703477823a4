#include "calibration/step_errors.h"

#include <algorithm>
#include <cmath>

#include "calibration/linear_misfit.h"
#include "calibration/side_by_side.h"

namespace lacuna {
namespace {

// The factor p, from the whitened changes by the first halving and by the second: rows in m, N and
// N m have no common size otherwise.
double ChangePerHalving(TimeScheme scheme, const Eigen::VectorXd& first,
                        const Eigen::VectorXd& second) {
  constexpr double kSecondOrder = 4;
  const double least = std::exp2(OrderOf(scheme));
  const double along = first.dot(second);
  if (!(along > 0)) return least;
  return std::clamp(first.squaredNorm() / along, least, kSecondOrder);
}

// The longest step that a prediction takes, s. Quasi-static steps end at the frames, so that a
// longer time_step has no effect, and half of it may have none either.
double LongestStep(const PredictionStudy& study) {
  if (study.scheme != TimeScheme::kQuasiStatic) return study.time_step;
  double between_frames = 0;
  for (const PredictedRecording& item : study.recordings)
    for (size_t k = 1; k < item.frames.size(); ++k)
      between_frames = std::max(between_frames, item.recording.times[item.frames[k]] -
                                                    item.recording.times[item.frames[k - 1]]);
  return between_frames > 0 ? std::min(study.time_step, between_frames) : study.time_step;
}

}  // namespace

std::optional<StepErrors> FindStepErrors(const CalibrationProblem& problem,
                                         const Eigen::VectorXd& values,
                                         const LinearisedMisfit& misfit,
                                         const std::function<void()>& on_frame) {
  const auto with_steps = [&](double ratio) {
    PredictionStudy study = problem.WithEstimatedNoise();
    study.time_step = LongestStep(study) / ratio;
    return CalibrationProblem(study, problem.body()->mesh)
        .Linearise(values, {.near = &misfit, .on_frame = on_frame})
        .residual;
  };
  const Eigen::VectorXd& whole = misfit.residual;
  Eigen::VectorXd half, quarter;
  ForEachStudy(problem, 2,
               [&](int64_t k) { k == 0 ? quarter = with_steps(4) : half = with_steps(2); });
  if (half.size() != whole.size() || quarter.size() != half.size()) return std::nullopt;
  const double power = ChangePerHalving(problem.study().scheme, WhitenedRows(half - whole, misfit),
                                        WhitenedRows(quarter - half, misfit));
  return StepErrors{quarter + (quarter - half) / (power - 1) - whole,
                    (quarter - half) - (half - whole) / power};
}

}  // namespace lacuna
