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

// Two recordings tell together what one with all of their frames would.
TEST(CommonErrors, AreThoseOfAllRecordings) {
  constexpr int kFrames = 5;
  std::srand(3);
  std::vector<Eigen::Matrix3d> deformation;
  for (int k = 0; k < 2 * kFrames; ++k)
    deformation.push_back(Eigen::Matrix3d::Identity() + 0.5 * Eigen::Matrix3d::Random());
  const Eigen::VectorXd residual = Eigen::VectorXd::Random(6 * kFrames);
  std::vector<double> count(2 * kFrames, 1);
  count[3] = 0;
  const MeasurementErrors errors{0.3, 0.7};
  const std::vector<char> all(kFrames, 1);
  const Eigen::MatrixXd one = CommonError(residual, count, 2, errors, all, deformation);

  CommonErrors together(3, 4);  // of places, two of which nobody sees
  together.Add(residual.head(12), {count.begin(), count.begin() + 4}, errors, {1, 1},
               {deformation.begin(), deformation.begin() + 4}, {3, 1});
  // The other frames, with the points in the opposite order.
  Eigen::VectorXd rest = residual.tail(18);
  std::vector<Eigen::Matrix3d> of_rest(deformation.begin() + 4, deformation.end());
  for (size_t frame = 0; frame < 3; ++frame) {
    std::swap(of_rest[2 * frame], of_rest[2 * frame + 1]);
    const Eigen::Index row = 6 * static_cast<Eigen::Index>(frame);
    rest.segment<3>(row).swap(rest.segment<3>(row + 3));
  }
  together.Add(rest, std::vector<double>(6, 1), errors, {1, 1, 1}, of_rest, {1, 3});
  const Eigen::MatrixXd mean = together.Mean();
  EXPECT_LT((mean.col(3) - one.col(0)).norm(), 1e-14);  // rounding
  EXPECT_LT((mean.col(1) - one.col(1)).norm(), 1e-14);
  EXPECT_EQ(mean.col(0).norm() + mean.col(2).norm(), 0);
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
