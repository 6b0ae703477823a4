#include "registration/displacement_field.h"

#include <glog/logging.h>

#include <cmath>
#include <limits>
#include <utility>

#include "core/parallel.h"

namespace lacuna {

DisplacementField::DisplacementField(const Eigen::Vector3d& centre, double scale,
                                     GaussianBasis basis, Eigen::Matrix3Xd coefficients,
                                     Eigen::MatrixXd covariance, double unseen_variance)
    : centre_(centre),
      scale_(scale),
      basis_(std::move(basis)),
      coefficients_(std::move(coefficients)),
      covariance_(std::move(covariance)),
      unseen_variance_(unseen_variance) {
  CHECK_EQ(coefficients_.cols(), basis_.Rank());
  CHECK(covariance_.size() == 0 || covariance_.rows() == basis_.Rank());
}

Eigen::Matrix3Xd DisplacementField::Normalised(const Eigen::Matrix3Xd& points) const {
  return (points.colwise() - centre_) / scale_;
}

Eigen::Matrix3Xd DisplacementField::Evaluate(const Eigen::Matrix3Xd& points) const {
  if (IsEmpty()) return Eigen::Matrix3Xd::Zero(3, points.cols());
  return scale_ * coefficients_ * basis_.Values(Normalised(points));
}

Eigen::VectorXd DisplacementField::StandardDeviation(const Eigen::Matrix3Xd& points) const {
  const Eigen::Index n = points.cols();
  if (covariance_.size() == 0) {
    return Eigen::VectorXd::Constant(n, std::numeric_limits<double>::quiet_NaN());
  }
  const Eigen::MatrixXd values = basis_.Values(Normalised(points));
  Eigen::VectorXd deviation(n);
  constexpr int kPointsPerTask = 256;
  ParallelBlocks(n, kPointsPerTask, [&](int64_t begin, int64_t end) {
    const auto part = values.middleCols(begin, end - begin);
    const Eigen::RowVectorXd seen = part.cwiseProduct(covariance_ * part).colwise().sum();
    const Eigen::RowVectorXd missed =
        (basis_.Variance() - part.colwise().squaredNorm().array()).max(0.0);
    deviation.segment(begin, end - begin) =
        scale_ * (seen + unseen_variance_ * missed).cwiseMax(0.0).cwiseSqrt().transpose();
  });
  return deviation;
}

}  // namespace lacuna
