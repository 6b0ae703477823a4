#include "analysis/measurement_errors.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>

namespace lacuna {
namespace {

// Three points over seven frames: the first is not seen in two of them, the last never.
struct Sample {
  static constexpr int kPoints = 3, kFrames = 7, kColumns = 5;
  static constexpr double kNoise = 0.3, kCommon = 2.0;

  Sample(int components_of_point, int most) : components(components_of_point) {
    for (int k = 0; k < kPoints * kFrames; ++k) count.push_back(1 + k % most);
    count[0] = count[3 * kPoints] = 0;
    for (int f = 0; f < kFrames; ++f) count[f * kPoints + 2] = 0;
    rows = Eigen::MatrixXd::Random(components * kPoints * kFrames, kColumns);
    for (int k = 0; k < kPoints * kFrames; ++k)
      if (count[k] == 0) rows.middleRows(components * k, components).setZero();
  }

  // Rows of the frames that see a point, one component, and the covariance of their errors.
  Eigen::MatrixXd RowsOf(int point, int component, Eigen::MatrixXd* covariance) const {
    std::vector<Eigen::Index> seen;
    std::vector<double> variance;
    for (int f = 0; f < kFrames; ++f) {
      const int at = f * kPoints + point;
      if (count[at] == 0) continue;
      seen.push_back(components * at + component);
      variance.push_back(kNoise * kNoise / count[at]);
    }
    const Eigen::Index n = static_cast<Eigen::Index>(seen.size());
    *covariance = kCommon * kCommon * Eigen::MatrixXd::Ones(n, n);
    for (Eigen::Index i = 0; i < n; ++i) (*covariance)(i, i) += variance[i];
    return rows(seen, Eigen::all);
  }

  int components = 0;
  std::vector<double> count;
  Eigen::MatrixXd rows;
};

TEST(Whitening, IsByTheInverseRootOfTheCovariance) {
  for (const auto& [components, most] : {std::pair(3, 1), std::pair(1, 9)}) {
    const Sample sample(components, most);
    const Eigen::MatrixXd white =
        Whitened(sample.rows, sample.count, Sample::kPoints, {Sample::kNoise, Sample::kCommon});
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(Sample::kColumns, Sample::kColumns);
    for (int point = 0; point < Sample::kPoints - 1; ++point) {
      for (int c = 0; c < components; ++c) {
        Eigen::MatrixXd covariance;
        const Eigen::MatrixXd own = sample.RowsOf(point, c, &covariance);
        gram += own.transpose() * covariance.ldlt().solve(own);
      }
    }
    // Rounding.
    EXPECT_LT((white.transpose() * white - gram).norm(), 1e-12 * gram.norm());
    for (size_t k = 0; k < sample.count.size(); ++k)
      EXPECT_EQ(white.middleRows(components * k, components).norm() == 0, sample.count[k] == 0);
  }
  // A place that is known for sure takes nothing away.
  const Sample sample(3, 1);
  EXPECT_EQ(Whitened(sample.rows, sample.count, Sample::kPoints, {Sample::kNoise, 0}),
            sample.rows / Sample::kNoise);
}

// cov(c, r) cov(r)⁻¹ r, for the part c that all frames share.
TEST(CommonError, IsTheMeanOfItsPosterior) {
  for (const auto& [components, most] : {std::pair(3, 1), std::pair(1, 9)}) {
    const Sample sample(components, most);
    const Eigen::MatrixXd common =
        CommonError(sample.rows.col(0), sample.count, Sample::kPoints,
                    {Sample::kNoise, Sample::kCommon}, std::vector<char>(Sample::kFrames, 1));
    ASSERT_EQ(common.rows(), components);
    for (int point = 0; point < Sample::kPoints - 1; ++point) {
      for (int c = 0; c < components; ++c) {
        Eigen::MatrixXd covariance;
        const Eigen::MatrixXd own = sample.RowsOf(point, c, &covariance);
        const Eigen::VectorXd weights = covariance.ldlt().solve(Eigen::VectorXd(own.col(0)));
        EXPECT_NEAR(common(c, point), Sample::kCommon * Sample::kCommon * weights.sum(), 1e-12);
      }
    }
    EXPECT_EQ(common.col(Sample::kPoints - 1).norm(), 0);
    // Frames that are not among those that tell say nothing.
    EXPECT_EQ(CommonError(sample.rows.col(0), sample.count, Sample::kPoints,
                          {Sample::kNoise, Sample::kCommon}, std::vector<char>(Sample::kFrames, 0))
                  .norm(),
              0);
  }
}

// A marker that lies δ off shows it turned with the object; then δ is found again.
TEST(CommonError, IsOnTheUndeformedObject) {
  constexpr int kFrames = 40;
  const Eigen::Vector3d error(0.4, -1.1, 0.7);
  std::vector<Eigen::Matrix3d> deformation;
  Eigen::VectorXd residual(3 * kFrames);
  for (int f = 0; f < kFrames; ++f) {
    deformation.push_back(Eigen::AngleAxisd(0.1 * f, Eigen::Vector3d(1, 2, -1).normalized()) *
                          Eigen::Scaling(1 + 0.01 * f));
    residual.segment<3>(3 * f) = deformation.back() * error;
  }
  const std::vector<double> count(kFrames, 1);
  const MeasurementErrors errors{1e-3, 1};  // the prior pulls by a part in 4e7
  EXPECT_LT(
      (CommonError(residual, count, 1, errors, std::vector<char>(kFrames, 1), deformation) - error)
          .norm(),
      1e-6);
  EXPECT_LT(Whitened(residual, count, 1, errors, deformation).norm(), 2);  // |error| in priors
  EXPECT_GT(Whitened(residual, count, 1, errors).norm(), 1000);
}

}  // namespace
}  // namespace lacuna
