#include "diagnosis/hypothesis_score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "diagnosis/thresholds.h"

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

std::vector<int> IndexRange(Eigen::Index first, Eigen::Index count) {
  std::vector<int> range(static_cast<size_t>(count));
  std::iota(range.begin(), range.end(), static_cast<int>(first));
  return range;
}

std::vector<int> Joined(std::vector<int> a, const std::vector<int>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

WeighedColumns WeighColumns(const LinearisedMisfit& misfit, const Eigen::MatrixXd& columns,
                            const std::vector<LinearPrior>& priors, double correlation_time) {
  Eigen::MatrixXd rows(misfit.residual.size(), columns.cols() + 1);
  rows << misfit.residual, columns;
  const Eigen::MatrixXd all = WhitenedRows(rows, misfit, {.correlation_time = correlation_time});
  const Eigen::MatrixXd fitted =
      WhitenedRows(rows, misfit, {.correlation_time = correlation_time, .fitted_only = true});
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

}  // namespace lacuna
