#include "calibration/reaction_errors.h"

#include <algorithm>
#include <cmath>

#include "calibration/reading_mistakes.h"

namespace lacuna {
namespace {

ReactionMeasure MeasureOver(const Eigen::VectorXd& residual, const ReactionMisfit& misfit,
                            const std::vector<char>& fitted, bool which, double deviation) {
  ReactionMeasure measure;
  double squares = 0;
  for (size_t f = 0; f < fitted.size(); ++f) {
    if (static_cast<bool>(fitted[f]) != which) continue;
    int read = 0;
    for (int c = 0; c < misfit.components; ++c) {
      const size_t row = f * static_cast<size_t>(misfit.components) + static_cast<size_t>(c);
      if (misfit.count[row] == 0) continue;
      const double error = std::abs(residual[static_cast<Eigen::Index>(row)]);
      squares += error * error;
      measure.largest = std::max(measure.largest, error);
      ++read;
    }
    measure.values += read;
    measure.frames += read > 0;
  }
  if (measure.values == 0) return measure;
  measure.rms = std::sqrt(squares / measure.values);
  measure.rms_over_sigma = measure.rms / deviation;
  return measure;
}

}  // namespace

FittedReaction MeasureReaction(const MeasuredReaction& reading, const ReactionMisfit& misfit,
                               const std::vector<double>& times, const std::vector<char>& fitted,
                               const std::vector<char>& tells_tare, bool forces_are_known) {
  FittedReaction reaction;
  reaction.name = reading.name;
  reaction.labels = reading.labels;
  reaction.is_torque = reading.is_torque;
  reaction.is_opposite = misfit.sign < 0;
  reaction.deviation = reading.deviation;
  reaction.deviation_is_estimated = reading.deviation_is_estimated;
  reaction.tare_deviation = reading.tare_deviation;
  reaction.largest_reading = reading.values.cwiseAbs().maxCoeff();
  const Eigen::VectorXd tare = TareOf(misfit, reading, tells_tare);
  reaction.tare.assign(tare.begin(), tare.end());
  const Eigen::VectorXd residual =
      misfit.residual - tare.replicate(static_cast<Eigen::Index>(fitted.size()), 1);
  reaction.in_fit = MeasureOver(residual, misfit, fitted, true, reading.deviation);
  reaction.held_out = MeasureOver(residual, misfit, fitted, false, reading.deviation);
  if (std::max(reaction.in_fit.rms, reaction.held_out.rms) >
      kConsiderableReactionError * reaction.largest_reading)
    reaction.likely_mistakes = FindReadingMistakes(reading, misfit, times, forces_are_known);
  return reaction;
}

}  // namespace lacuna
