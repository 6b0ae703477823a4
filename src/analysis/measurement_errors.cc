#include "analysis/measurement_errors.h"

#include <glog/logging.h>

#include <Eigen/Cholesky>

#include "analysis/series_noise.h"

namespace lacuna {

Eigen::MatrixXd Whitened(const Eigen::MatrixXd& rows, const std::vector<double>& count, int points,
                         const MeasurementErrors& errors,
                         const std::vector<Eigen::Matrix3d>& deformation) {
  SeriesLayout layout;
  layout.deformation = deformation;
  if (!count.empty()) {
    const size_t components = static_cast<size_t>(rows.rows()) / count.size();
    layout.series = static_cast<int>(components) * points;
    layout.times.resize(count.size() / static_cast<size_t>(points));  // white: times do not matter
    for (const double n : count) layout.count.insert(layout.count.end(), components, n);
  }
  return Whitened(rows, layout, {errors.noise, 0, errors.common});
}

Eigen::MatrixXd CommonError(const Eigen::VectorXd& residual, const std::vector<double>& count,
                            int points, const MeasurementErrors& errors,
                            const std::vector<char>& among,
                            const std::vector<Eigen::Matrix3d>& deformation) {
  CHECK_EQ(count.size(), among.size() * points);
  if (count.empty()) return Eigen::MatrixXd::Zero(1, points);
  const Eigen::Index components = residual.size() / static_cast<Eigen::Index>(count.size());
  const double ratio = errors.common / errors.noise;
  Eigen::MatrixXd common(components, points);
  for (int point = 0; point < points; ++point) {
    Eigen::MatrixXd information = Eigen::MatrixXd::Identity(components, components);
    Eigen::VectorXd toward = Eigen::VectorXd::Zero(components);
    for (size_t f = 0; f < among.size(); ++f) {
      const size_t at = f * static_cast<size_t>(points) + static_cast<size_t>(point);
      if (!among[f] || count[at] == 0) continue;
      Eigen::MatrixXd shows = Eigen::MatrixXd::Identity(components, components);
      if (!deformation.empty()) shows = deformation[at];
      const double weight = count[at] * ratio * ratio;
      information += weight * shows.transpose() * shows;
      toward += weight * shows.transpose() *
                residual.segment(components * static_cast<Eigen::Index>(at), components);
    }
    common.col(point) = information.llt().solve(toward);
  }
  return common;
}

}  // namespace lacuna
