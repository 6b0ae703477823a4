#include "analysis/measurement_errors.h"

#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <iterator>
#include <numeric>

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

CommonErrors::CommonErrors(Eigen::Index components, Eigen::Index places)
    : components_(components),
      information_(static_cast<size_t>(places), Eigen::MatrixXd::Identity(components, components)),
      toward_(Eigen::MatrixXd::Zero(components, places)) {}

void CommonErrors::Add(const Eigen::VectorXd& residual, const std::vector<double>& count,
                       const MeasurementErrors& errors, const std::vector<char>& among,
                       const std::vector<Eigen::Matrix3d>& deformation,
                       const std::vector<int>& place_of_point) {
  const size_t points = place_of_point.size();
  CHECK_EQ(count.size(), among.size() * points);
  CHECK_EQ(residual.size(), components_ * std::ssize(count));
  const double ratio = errors.common / errors.noise;
  for (size_t at = 0; at < count.size(); ++at) {
    if (!among[at / points] || count[at] == 0) continue;
    const int place = place_of_point[at % points];
    Eigen::MatrixXd shows = Eigen::MatrixXd::Identity(components_, components_);
    if (!deformation.empty()) shows = deformation[at];
    const double weight = count[at] * ratio * ratio;
    information_[static_cast<size_t>(place)] += weight * shows.transpose() * shows;
    toward_.col(place) +=
        weight * shows.transpose() *
        residual.segment(components_ * static_cast<Eigen::Index>(at), components_);
  }
}

Eigen::MatrixXd CommonErrors::Mean() const {
  Eigen::MatrixXd mean(components_, toward_.cols());
  for (Eigen::Index place = 0; place < mean.cols(); ++place)
    mean.col(place) = information_[static_cast<size_t>(place)].llt().solve(toward_.col(place));
  return mean;
}

Eigen::MatrixXd CommonError(const Eigen::VectorXd& residual, const std::vector<double>& count,
                            int points, const MeasurementErrors& errors,
                            const std::vector<char>& among,
                            const std::vector<Eigen::Matrix3d>& deformation) {
  CHECK_EQ(count.size(), among.size() * static_cast<size_t>(points));
  if (count.empty()) return Eigen::MatrixXd::Zero(1, points);
  std::vector<int> places(static_cast<size_t>(points));
  std::iota(places.begin(), places.end(), 0);
  CommonErrors common(residual.size() / std::ssize(count), points);
  common.Add(residual, count, errors, among, deformation, places);
  return common.Mean();
}

}  // namespace lacuna
