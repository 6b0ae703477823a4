#include "study/measurement_errors.h"

#include <glog/logging.h>

#include <cmath>

namespace lacuna {

Eigen::MatrixXd Whitened(const Eigen::MatrixXd& rows, const std::vector<int>& count, int points,
                         const MeasurementErrors& errors) {
  CHECK_GT(errors.noise, 0);
  Eigen::MatrixXd white = rows / errors.noise;
  if (count.empty()) return white;
  const Eigen::Index components = rows.rows() / static_cast<Eigen::Index>(count.size());
  const Eigen::Index frames = static_cast<Eigen::Index>(count.size()) / points;
  const double ratio = errors.common / errors.noise;
  for (int point = 0; point < points; ++point) {
    // In units of σ/√n_f the covariance is I + u uᵀ with u_f = (s/σ) √n_f; its inverse root takes a
    // share of the part along u away.
    Eigen::VectorXd root(frames);
    double seen = 0;
    for (Eigen::Index f = 0; f < frames; ++f) {
      root[f] = std::sqrt(static_cast<double>(count[f * points + point]));
      seen += count[f * points + point];
    }
    if (seen == 0) continue;
    const double share = 1 - 1 / std::sqrt(1 + seen * ratio * ratio);
    for (Eigen::Index c = 0; c < components; ++c) {
      for (Eigen::Index k = 0; k < rows.cols(); ++k) {
        double along = 0;
        for (Eigen::Index f = 0; f < frames; ++f) {
          double& entry = white(components * (f * points + point) + c, k);
          entry *= root[f];
          along += root[f] * entry;
        }
        along /= seen;
        for (Eigen::Index f = 0; f < frames; ++f)
          if (root[f] > 0)
            white(components * (f * points + point) + c, k) -= share * (root[f] * along);
      }
    }
  }
  return white;
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
