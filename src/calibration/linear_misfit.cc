#include "calibration/linear_misfit.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "analysis/series_noise.h"

namespace lacuna {

const LinearisedMisfit::Part& LinearisedMisfit::PointsOf(size_t recording) const {
  const auto found = std::find_if(parts.begin(), parts.end(), [&](const Part& part) {
    return part.recording == recording && part.IsOfPoints();
  });
  CHECK(found != parts.end());
  return *found;
}

std::vector<LinearPrior> PriorsAbout(const std::vector<CalibratedParameter>& parameters,
                                     const Eigen::VectorXd& values) {
  std::vector<LinearPrior> priors;
  for (size_t k = 0; k < parameters.size(); ++k) {
    const CalibratedParameter& parameter = parameters[k];
    const double value = values[static_cast<Eigen::Index>(k)];
    const double mean = PriorMeanOf(parameter);
    const double unit = parameter.log_scale ? value : 1;
    const double change = parameter.log_scale ? std::log(mean / value) : mean - value;
    priors.push_back({unit * change, unit * parameter.prior_deviation, false});
  }
  return priors;
}

Eigen::VectorXd MovedBy(const std::vector<CalibratedParameter>& parameters,
                        const Eigen::VectorXd& values, const Eigen::VectorXd& change) {
  Eigen::VectorXd moved = values;
  for (size_t k = 0; k < parameters.size(); ++k) {
    const Eigen::Index at = static_cast<Eigen::Index>(k);
    const double by = change[at];
    moved[at] = std::clamp(
        parameters[k].log_scale ? values[at] * std::exp(by / values[at]) : values[at] + by,
        parameters[k].min, parameters[k].max);
  }
  return moved;
}

Eigen::MatrixXd WhitenedRows(const Eigen::MatrixXd& rows, const LinearisedMisfit& misfit,
                             const WhiteningOptions& options) {
  std::vector<NoisyRecording> recordings;
  for (const LinearisedMisfit::Part& part : misfit.parts)
    recordings.push_back({part.first_row,
                          &part.layout,
                          {part.errors.noise, options.correlation_time, part.errors.common},
                          options.fitted_only ? &part.fitted : nullptr});
  return Whitened(rows, recordings);
}

Eigen::MatrixXd FittedRows(const Eigen::MatrixXd& rows, const LinearisedMisfit& misfit) {
  Eigen::MatrixXd kept(rows.rows(), rows.cols());
  Eigen::Index count = 0;
  for (const LinearisedMisfit::Part& part : misfit.parts) {
    for (size_t f = 0; f < part.fitted.size(); ++f) {
      if (!part.fitted[f]) continue;
      const Eigen::Index first = part.first_row + static_cast<Eigen::Index>(f) * part.layout.series;
      kept.middleRows(count, part.layout.series) = rows.middleRows(first, part.layout.series);
      count += part.layout.series;
    }
  }
  kept.conservativeResize(count, Eigen::NoChange);
  return kept;
}

ResidualEvaluation FittedEvaluation(const LinearisedMisfit& misfit) {
  ResidualEvaluation prediction;
  prediction.usable = misfit.usable;
  prediction.message = misfit.message;
  if (!misfit.usable) return prediction;
  prediction.residual =
      FittedRows(WhitenedRows(misfit.residual, misfit, {.fitted_only = true}), misfit);
  prediction.jacobian =
      FittedRows(WhitenedRows(misfit.jacobian, misfit, {.fitted_only = true}), misfit);
  for (const LinearisedMisfit::Part& part : misfit.parts) {
    const Eigen::Index first = static_cast<Eigen::Index>(prediction.before.size());
    const Eigen::Index series = part.layout.series;
    const Eigen::Index rows = series * std::count(part.fitted.begin(), part.fitted.end(), 1);
    for (Eigen::Index row = 0; row < rows; ++row)
      prediction.before.push_back(row < series ? -1 : first + row - series);
    for (Eigen::Index row = 0; row < part.layout.Rows(); ++row)
      prediction.unobserved += part.fitted[static_cast<size_t>(row / series)] &&
                               part.layout.count[static_cast<size_t>(row)] == 0;
  }
  return prediction;
}

NoiseLevel LevelOf(const Eigen::VectorXd& left, const LinearisedMisfit& misfit,
                   Eigen::Index parameters, double least) {
  NoiseLevel level;
  const auto pooled = [&](const Eigen::VectorXd& rows) {
    SeriesStatistics mean{0, 0, 0};
    const auto recordings =
        std::count_if(misfit.parts.begin(), misfit.parts.end(),
                      [](const LinearisedMisfit::Part& part) { return part.IsOfPoints(); });
    for (const LinearisedMisfit::Part& part : misfit.parts) {
      if (!part.IsOfPoints()) continue;
      const SeriesStatistics own =
          Statistics(rows.segment(part.first_row, part.layout.Rows()), part.layout);
      const double share = 1.0 / static_cast<double>(recordings);
      mean.lag_one += share * own.lag_one;
      mean.spacing += share * own.spacing;
      mean.long_run += share * own.long_run;
    }
    return mean;
  };
  level.correlation_time = CorrelationTime(pooled(WhitenedRows(left, misfit)));
  const Eigen::VectorXd white =
      WhitenedRows(left, misfit, {.correlation_time = level.correlation_time});
  const double freedom =
      static_cast<double>(std::max<Eigen::Index>(1, ObservedRows(misfit) - parameters));
  level.variance = std::max(least, white.squaredNorm() / freedom) * pooled(white).long_run;
  return level;
}

Eigen::Index ObservedRows(const LinearisedMisfit& misfit, bool fitted_only) {
  Eigen::Index observed = 0;
  for (const LinearisedMisfit::Part& part : misfit.parts)
    for (Eigen::Index row = 0; row < part.layout.Rows(); ++row)
      observed += part.layout.count[row] > 0 &&
                  (!fitted_only || part.fitted[row / part.layout.series] != 0);
  return observed;
}

double RmsOverSigma(const Eigen::VectorXd& residual, const LinearisedMisfit& misfit,
                    bool fitted_only) {
  const Eigen::Index observed = std::max<Eigen::Index>(1, ObservedRows(misfit, fitted_only));
  return std::sqrt(WhitenedRows(residual, misfit, {.fitted_only = fitted_only}).squaredNorm() /
                   static_cast<double>(observed));
}

double HeldOutInNoise(const Eigen::VectorXd& whitened, const LinearisedMisfit& misfit) {
  double fitted_squares = 0, held_out_squares = 0;
  Eigen::Index fitted_rows = 0, held_out_rows = 0;
  for (const LinearisedMisfit::Part& part : misfit.parts) {
    for (Eigen::Index row = 0; row < part.layout.Rows(); ++row) {
      if (part.layout.count[row] == 0) continue;
      const bool fitted = part.fitted[row / part.layout.series];
      (fitted ? fitted_squares : held_out_squares) += std::pow(whitened[part.first_row + row], 2);
      ++(fitted ? fitted_rows : held_out_rows);
    }
  }
  if (held_out_rows > 0) return std::sqrt(held_out_squares / static_cast<double>(held_out_rows));
  return fitted_rows > 0 ? std::sqrt(fitted_squares / static_cast<double>(fitted_rows)) : 0;
}

}  // namespace lacuna
