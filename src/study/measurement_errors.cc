#include "study/measurement_errors.h"

#include <glog/logging.h>

#include "analysis/series_noise.h"

namespace lacuna {

Eigen::MatrixXd Whitened(const Eigen::MatrixXd& rows, const std::vector<int>& count, int points,
                         const MeasurementErrors& errors) {
  SeriesLayout layout;
  if (!count.empty()) {
    const size_t components = static_cast<size_t>(rows.rows()) / count.size();
    layout.series = static_cast<int>(components) * points;
    layout.times.resize(count.size() / static_cast<size_t>(points));  // white: times do not matter
    for (const int n : count) layout.count.insert(layout.count.end(), components, n);
  }
  return Whitened(rows, layout, {errors.noise, 0, errors.common});
}

Eigen::MatrixXd CommonError(const Eigen::VectorXd& residual, const std::vector<int>& count,
                            int points, const MeasurementErrors& errors,
                            const std::vector<char>& among) {
  CHECK_EQ(count.size(), among.size() * points);
  if (count.empty()) return Eigen::MatrixXd::Zero(1, points);
  const Eigen::Index components = residual.size() / static_cast<Eigen::Index>(count.size());
  Eigen::MatrixXd common = Eigen::MatrixXd::Zero(components, points);
  Eigen::VectorXd seen = Eigen::VectorXd::Zero(points);
  for (size_t f = 0; f < among.size(); ++f) {
    if (!among[f]) continue;
    for (int point = 0; point < points; ++point) {
      const Eigen::Index at = static_cast<Eigen::Index>(f) * points + point;
      if (count[at] == 0) continue;
      common.col(point) += count[at] * residual.segment(components * at, components);
      seen[point] += count[at];
    }
  }
  const double ratio = errors.common / errors.noise;
  for (int point = 0; point < points; ++point)
    common.col(point) *= ratio * ratio / (1 + seen[point] * ratio * ratio);
  return common;
}

}  // namespace lacuna
