#include "calibration/reading_mistakes.h"

#include <cmath>
#include <limits>

namespace lacuna {
namespace {

constexpr double kExplained = 0.05;  // of the squared misfit, is left by a likely mistake
// A factor up to this, or down to its inverse, may be an error of the model: units differ by more.
constexpr double kOfModel = 1.25;

// Predictions and readings of one component in the frames that have both.
struct Series {
  std::vector<double> predicted, read;
};

// Σ (read − a predicted)² with the best factor a.
struct FactorFit {
  double factor = 0, remains = std::numeric_limits<double>::infinity();
};
FactorFit FitFactor(const std::vector<Series>& components) {
  double predicted = 0, read = 0, both = 0;
  for (const Series& series : components)
    for (size_t k = 0; k < series.read.size(); ++k) {
      predicted += series.predicted[k] * series.predicted[k];
      read += series.read[k] * series.read[k];
      both += series.predicted[k] * series.read[k];
    }
  constexpr double kRounding = 1e-20;  // a prediction of 0 is the difference of two equal numbers
  if (!(predicted > kRounding * read)) return {};
  return {both / predicted, read - both * both / predicted};
}

double Mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

void SubtractMean(std::vector<double>* values) {
  const double mean = Mean(*values);
  for (double& value : *values) value -= mean;
}

// The reading `delay` (s) after each frame, beside the prediction in it.
std::vector<Series> SeriesOf(const MeasuredReaction& reading, const ReactionMisfit& misfit,
                             const std::vector<double>& times, double delay) {
  std::vector<Series> components(static_cast<size_t>(misfit.components));
  for (size_t f = 0; f < times.size(); ++f)
    for (size_t c = 0; c < components.size(); ++c) {
      const size_t row = f * components.size() + c;
      if (misfit.count[row] == 0 || !reading.Covers(times[f] + delay)) continue;
      const auto own = static_cast<Eigen::Index>(c);
      const double there = misfit.sign * ReadingAt(reading, times[f])[own];
      components[c].predicted.push_back(misfit.residual[static_cast<Eigen::Index>(row)] + there);
      components[c].read.push_back(misfit.sign * ReadingAt(reading, times[f] + delay)[own]);
    }
  return components;
}

size_t CountOf(const std::vector<Series>& components) {
  size_t count = 0;
  for (const Series& series : components) count += series.read.size();
  return count;
}

double SquaredMisfit(const std::vector<Series>& components) {
  double sum = 0;
  for (const Series& series : components)
    for (size_t k = 0; k < series.read.size(); ++k)
      sum += std::pow(series.predicted[k] - series.read[k], 2);
  return sum;
}

bool IsNearOne(double factor) { return factor <= kOfModel && factor >= 1 / kOfModel; }

struct OffsetFit {
  double factor = 0;
  double offset = 0;  // the largest where each component has one
};
// Nothing where an offset of each component beside a joint factor explains too little.
std::optional<OffsetFit> FindOffset(const std::vector<Series>& components, double most) {
  std::vector<Series> centred = components;
  for (Series& series : centred) {
    if (series.read.empty()) continue;
    SubtractMean(&series.predicted);
    SubtractMean(&series.read);
  }
  const FactorFit fit = FitFactor(centred);
  if (!(fit.remains <= most) || fit.factor <= 0) return std::nullopt;
  OffsetFit found{fit.factor};
  for (const Series& series : components) {
    if (series.read.empty()) continue;
    const double offset = Mean(series.read) - fit.factor * Mean(series.predicted);
    if (std::abs(offset) > std::abs(found.offset)) found.offset = offset;
  }
  return found;
}

std::optional<double> FindDelay(const MeasuredReaction& reading, const ReactionMisfit& misfit,
                                const std::vector<double>& times, size_t count, double most,
                                bool forces_are_known) {
  constexpr int kSteps = 40;           // on either side
  constexpr double kFarthest = 0.25;   // of the time of all frames
  constexpr double kFewestRows = 0.6;  // that a delayed reading must cover
  const double step = kFarthest * (times.back() - times.front()) / kSteps;
  std::optional<double> best;
  for (int k = -kSteps; k <= kSteps; ++k) {
    const std::vector<Series> delayed = SeriesOf(reading, misfit, times, k * step);
    const auto rows = static_cast<double>(CountOf(delayed)), all = static_cast<double>(count);
    if (rows < kFewestRows * all) continue;
    const FactorFit fit = FitFactor(delayed);
    const double remains = fit.remains * all / rows;
    if (!(remains <= most) || fit.factor <= 0) continue;
    if (forces_are_known && !IsNearOne(fit.factor)) continue;
    most = remains;
    best = k * step;
  }
  return best;
}

}  // namespace

ReadingMistakes FindReadingMistakes(const MeasuredReaction& reading, const ReactionMisfit& misfit,
                                    const std::vector<double>& times, bool forces_are_known) {
  ReadingMistakes mistakes;
  if (times.size() < 2) return mistakes;
  const std::vector<Series> components = SeriesOf(reading, misfit, times, 0);
  const double most = kExplained * SquaredMisfit(components);
  const FactorFit fit = FitFactor(components);
  if (fit.remains <= most) {
    mistakes.factor = fit.factor;
    return mistakes;
  }
  if (const std::optional<OffsetFit> found = FindOffset(components, most)) {
    mistakes.offset = found->offset;
    if (forces_are_known && !IsNearOne(found->factor)) mistakes.factor = found->factor;
  }
  mistakes.delay = FindDelay(reading, misfit, times, CountOf(components), most, forces_are_known);
  return mistakes;
}

}  // namespace lacuna
