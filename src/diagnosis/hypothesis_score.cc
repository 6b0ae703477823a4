#include "diagnosis/hypothesis_score.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "diagnosis/thresholds.h"
#include "scan/random_bits.h"

namespace lacuna {
namespace {

// What remains of a column's square after a projection, relative to it, is rounding below this.
constexpr double kRounding = 1e-8;

// Expected rms of the held-out frames, over σ, after a fit of the `chosen` columns to the fitted
// ones.
double ExpectedHeldOut(const WeighedColumns& weighed, const std::vector<int>& chosen,
                       double variance, const LinearisedMisfit& misfit) {
  const LinearFit fit = weighed.fitted.Fit(chosen, variance);
  return HeldOutInNoise(weighed.residual + weighed.columns(Eigen::all, chosen) * fit.change,
                        misfit);
}

}  // namespace

std::vector<int> Joined(std::vector<int> a, const std::vector<int>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

WeighedColumns WeighColumns(const LinearisedMisfit& misfit, const Eigen::MatrixXd& columns,
                            const std::vector<LinearPrior>& priors, double correlation_time) {
  Eigen::MatrixXd rows(misfit.residual.size(), columns.cols() + 1);
  rows << misfit.residual, columns;
  const Eigen::MatrixXd all = WhitenedRows(rows, misfit, correlation_time, false);
  const Eigen::MatrixXd fitted = WhitenedRows(rows, misfit, correlation_time, true);
  const Eigen::Index count = columns.cols();
  return {LinearGaussianModel(all.col(0), all.rightCols(count), priors),
          LinearGaussianModel(fitted.col(0), fitted.rightCols(count), priors), all.col(0),
          all.rightCols(count)};
}

Score ScoreOf(const WeighedColumns& weighed, const std::vector<int>& base, const LinearFit& before,
              const std::vector<int>& own, double variance, const LinearisedMisfit& misfit) {
  Score score;
  const std::vector<int> with = Joined(base, own);
  const LinearFit after = weighed.all.Fit(with, variance);
  const Eigen::Index count = static_cast<Eigen::Index>(own.size());
  score.evidence = after.log_evidence - before.log_evidence;
  score.size = after.change.tail(count);
  score.deviation = after.deviation.tail(count);
  score.explained = before.misfit > 0 ? std::clamp(1 - after.misfit / before.misfit, 0.0, 1.0) : 0;
  score.held_out_rms_over_sigma = ExpectedHeldOut(weighed, with, variance, misfit);
  const Eigen::MatrixXd remaining = weighed.all.Remaining(base, own, own, variance);
  double raw = 0, visible = 0;
  score.detectable.setConstant(count, std::numeric_limits<double>::infinity());
  for (Eigen::Index k = 0; k < count; ++k) {
    const double unit = std::pow(weighed.all.Prior(own[k]).deviation, 2);
    const double square = weighed.all.Square(own[k]);
    raw += unit * square;
    visible += unit * remaining(k, k);
    if (remaining(k, k) > kRounding * square && remaining(k, k) > 0)
      score.detectable[k] =
          kThresholds.ranking.detectable_deviations * std::sqrt(variance / remaining(k, k));
  }
  if (raw > 0) score.absorbed = std::clamp(1 - visible / raw, 0.0, 1.0);
  return score;
}

namespace {

// The residual with the frames of each recording shifted in time, cyclically, and a random sign for
// each series.
Eigen::VectorXd ShuffledResidual(const Eigen::VectorXd& residual, const LinearisedMisfit& misfit,
                                 uint64_t draw) {
  Eigen::VectorXd shuffled = residual;
  for (const LinearisedMisfit::Part& part : misfit.parts) {
    const Eigen::Index frames = static_cast<Eigen::Index>(part.layout.times.size());
    const Eigen::Index series = part.layout.series;
    const Eigen::Index shift = static_cast<Eigen::Index>(RandomBits({draw, part.recording, 1}) %
                                                         static_cast<uint64_t>(frames));
    for (Eigen::Index s = 0; s < series; ++s) {
      const double sign =
          RandomBits({draw, part.recording, 2, static_cast<uint64_t>(s)}) % 2 == 0 ? 1 : -1;
      for (Eigen::Index f = 0; f < frames; ++f)
        shuffled[part.first_row + f * series + s] =
            sign * residual[part.first_row + (f + shift) % frames * series + s];
    }
  }
  return shuffled;
}

}  // namespace

double ControlEvidence(const WeighedColumns& weighed, const LinearisedMisfit& misfit,
                       const std::vector<int>& best, const std::vector<int>& base,
                       const std::vector<std::vector<int>>& effects, double variance) {
  const Eigen::VectorXd residual =
      weighed.residual + weighed.columns(Eigen::all, best) * weighed.all.Fit(best, variance).change;
  constexpr int kDraws = kThresholds.ranking.control_draws;
  std::vector<double> largest;
  for (uint64_t draw = 0; draw < kDraws; ++draw) {
    const LinearGaussianModel control =
        weighed.all.WithResidual(ShuffledResidual(residual, misfit, draw), weighed.columns);
    const double before = control.Fit(base, variance).log_evidence;
    double most = 0;
    for (const std::vector<int>& effect : effects)
      most = std::max(most, control.Fit(Joined(base, effect), variance).log_evidence - before);
    largest.push_back(most);
  }
  std::sort(largest.begin(), largest.end());
  return largest[kDraws - 1 - kThresholds.ranking.control_exceptions];
}

}  // namespace lacuna
