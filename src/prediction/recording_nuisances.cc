#include "prediction/recording_nuisances.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "fit/calibration.h"

namespace lacuna {
namespace {

// The nuisance parameters are fitted to this share of the recording's time.
constexpr double kNuisanceHorizon = 0.1;
// For scans, the number of times that correspondences are searched for.
constexpr int kRounds = 3;

// Appends the whitened rows of the load cells.
void AppendReadings(const RecordingModel& model, const Misfit& misfit,
                    ResidualEvaluation* prediction) {
  for (size_t k = 0; k < misfit.reactions.size(); ++k) {
    const ReactionMisfit& reaction = misfit.reactions[k];
    const auto whitened = [&](const Eigen::MatrixXd& rows) {
      return Whitened(rows, reaction.count, reaction.components,
                      ReadingErrors(model.Reactions()[k]));
    };
    const Eigen::Index before = prediction->residual.size(), more = reaction.residual.size();
    prediction->residual.conservativeResize(before + more);
    prediction->residual.tail(more) = whitened(reaction.residual);
    prediction->unobserved += std::count(reaction.count.begin(), reaction.count.end(), 0);
    if (prediction->jacobian.cols() == 0) continue;
    prediction->jacobian.conservativeResize(before + more, Eigen::NoChange);
    prediction->jacobian.bottomRows(more) = whitened(reaction.jacobian);
  }
}

}  // namespace

Eigen::VectorXd FitRecordingNuisances(const RecordingModel& model, MeasurementErrors errors,
                                      const std::optional<Eigen::MatrixXd>& place_offset) {
  if (place_offset) errors.common = 0;
  std::vector<CalibratedParameter> own;
  std::vector<MisfitDirection> directions;
  for (const auto& entry : model.nuisances()) {
    own.push_back(entry.prior);
    directions.push_back(entry.direction);
  }
  const PredictedRecording& item = model.recording();
  const std::vector<double>& times = item.recording.times;
  const double start = item.StartTime();
  const double until = start + kNuisanceHorizon * (times[item.frames.back()] - start);
  std::vector<int> beginning = item.frames;
  std::erase_if(beginning, [&](int frame) { return times[frame] > until; });
  const int rounds = item.ShowsScans() && !own.empty() ? kRounds : 1;
  Eigen::VectorXd values;
  for (int round = 0; round < rounds; ++round) {
    std::vector<Observed> kept;
    Eigen::VectorXd equilibrium;  // found by the last prediction
    const Calibration fitted = Calibrate(own, [&](const Eigen::VectorXd& at, bool with_jacobian) {
      Misfit misfit =
          model.Predict(beginning, at, with_jacobian ? directions : std::vector<MisfitDirection>{},
                        {kept.empty() ? nullptr : &kept, &equilibrium});
      if (misfit.summary.held.size() > 0) equilibrium = misfit.summary.held;
      ResidualEvaluation prediction{misfit.summary.IsUsable(), misfit.summary.message, {}, {}};
      if (!prediction.usable) return prediction;
      const auto whitened = [&](const Eigen::MatrixXd& rows) {
        return Whitened(rows, misfit.count, misfit.points, errors, misfit.deformation);
      };
      prediction.residual =
          whitened(place_offset ? misfit.ResidualWithout(*place_offset) : misfit.residual);
      prediction.unobserved =
          misfit.Components() * std::count(misfit.count.begin(), misfit.count.end(), 0);
      if (kept.empty()) kept = std::move(misfit.observed);
      if (with_jacobian) prediction.jacobian = whitened(misfit.jacobian);
      AppendReadings(model, misfit, &prediction);
      return prediction;
    });
    values = fitted.parameters;
    for (size_t k = 0; k < own.size() && values.size() > 0; ++k)
      own[k].start = values[static_cast<Eigen::Index>(k)];
  }
  return values;
}

}  // namespace lacuna
