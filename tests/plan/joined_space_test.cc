#include "plan/joined_space.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "diagnosis/projected_hypotheses.h"
#include "diagnosis/synthetic_space.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;

TEST(SpaceOfRivals, KeepsTheBaseAndTheRivals) {
  const SyntheticSpace synthetic;
  const HypothesisSpace all = synthetic.With(SyntheticSpace::Noise(1) - 9 * synthetic.Of("fibres"));
  const HypothesisSpace rivals = SpaceOfRivals(all, {"fibres", "mass_damping"});
  ASSERT_EQ(rivals.hypotheses.size(), 2u);
  EXPECT_EQ(rivals.hypotheses[0].name, "mass_damping");
  EXPECT_THAT(rivals.hypotheses[1].columns, ElementsAre(3));
  EXPECT_EQ(rivals.model.toward().size(), 4);
  const ProjectedHypotheses before(all), after(rivals);
  const Eigen::VectorXd factors = before.FactorsOfResidual();
  const Eigen::VectorXd kept = after.FactorsOfResidual();
  EXPECT_NEAR(kept[0], factors[1], 1e-9);
  EXPECT_NEAR(kept[1], factors[3], 1e-9);
}

// Two recordings. The second has a column of its own, which resembles an effect and has a prior
// that allows it an amount about as large as the noise.
struct TwoRecordings {
  SyntheticSpace first{0.3}, second{1.5};
  HypothesisSpace now = SpaceOfRivals(first.With(SyntheticSpace::Noise(2) - 9 * first.Of("drag")),
                                      {"drag", "mass_damping"});
  PlannedColumns planned{second.columns.leftCols(SyntheticSpace::kBase),
                         second.Of("drag") + 0.3 * second.Of("clock"),
                         {{0, 1, false}},
                         second.columns.middleCols(SyntheticSpace::kBase, 2)};
  JoinedSpace space{now, planned};

  // Of the planned recording: the columns of `now`, and the covariance matrix of its rows if all
  // amounts but that of its own column are known.
  Eigen::MatrixXd columns = second.columns.leftCols(SyntheticSpace::kBase + 2);
  Eigen::MatrixXd covariance =
      Eigen::MatrixXd::Identity(SyntheticSpace::kRows, SyntheticSpace::kRows) +
      planned.own * planned.own.transpose();
};

TEST(JoinedSpace, HasTheProductsOfBothRecordings) {
  const TwoRecordings two;
  const Eigen::MatrixXd first = two.first.columns.leftCols(SyntheticSpace::kBase + 2);
  const Eigen::MatrixXd expected =
      first.transpose() * first + two.columns.transpose() * two.covariance.llt().solve(two.columns);
  const HypothesisSpace& joined = two.space.joined();
  EXPECT_TRUE(joined.model.products().isApprox(expected, 1e-12));
  EXPECT_THAT(joined.base, ElementsAre(0, 1));
  EXPECT_THAT(joined.hypotheses[1].columns, ElementsAre(3));
  EXPECT_EQ(joined.model.Prior(2).deviation, 20);
  EXPECT_EQ(joined.rows, 2 * SyntheticSpace::kRows);
  EXPECT_EQ(joined.model.toward(), two.now.model.toward());  // no measurements yet
}

// The mean and the covariance matrix of the products of the planned recording, from those of its
// rows.
TEST(JoinedSpace, DrawsFromThePredictiveDistribution) {
  const TwoRecordings two;
  const FoundEffect drag = FindEffect(two.now, "drag");
  const std::vector<int> known = {0, 1, drag.columns[0]};
  Eigen::Matrix3d precision = two.now.model.products()(known, known);
  precision(2, 2) += 1.0 / (20 * 20);
  const Eigen::Matrix3d posterior = precision.inverse();
  const Eigen::Vector3d mean = -posterior * two.now.model.toward()(known);
  const Eigen::MatrixXd by_amounts = two.columns(Eigen::all, known);
  const Eigen::MatrixXd of_rows = two.covariance + by_amounts * posterior * by_amounts.transpose();
  const Eigen::MatrixXd from_rows = two.covariance.llt().solve(two.columns).transpose();
  const Eigen::VectorXd by_mean = by_amounts * mean;
  const Eigen::VectorXd expected = -from_rows * by_mean;
  const Eigen::MatrixXd spread = from_rows * of_rows * from_rows.transpose();

  constexpr int kDraws = 20000;
  constexpr int kColumns = SyntheticSpace::kBase + 2;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(kColumns);
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(kColumns, kColumns);
  for (int k = 0; k < kDraws; ++k) {
    const Eigen::VectorXd drawn =
        two.space.DrawToward(drag, 7, static_cast<uint64_t>(k)) - two.space.joined().model.toward();
    sum += drawn;
    squares += (drawn - expected) * (drawn - expected).transpose();
  }
  // Four standard errors and more: that of a product is at most √2 times the two deviations over
  // √kDraws. If the amount of the own column were left out, the variance for drag would be too
  // small by six times the tolerance.
  for (int k = 0; k < kColumns; ++k) {
    const double deviation = std::sqrt(spread(k, k));
    EXPECT_NEAR(sum[k] / kDraws, expected[k], 4 * deviation / std::sqrt(kDraws)) << k;
    for (int j = 0; j < kColumns; ++j)
      EXPECT_NEAR(squares(k, j) / kDraws, spread(k, j),
                  6 * deviation * std::sqrt(spread(j, j)) / std::sqrt(kDraws))
          << k << " " << j;
  }
}

// The recordings say that the effect, which can only be positive, is absent. Its size and a
// parameter that compensates for it have the means of the truncated normal distribution, and the
// size is hardly ever 0. The planned recording shows both without noise that counts.
TEST(JoinedSpace, DrawsPositiveAmountsFromTheTruncatedPosterior) {
  constexpr int kDrag = SyntheticSpace::kBase;
  SyntheticSpace first;
  first.priors[kDrag].positive = true;
  first.columns.col(0) += first.Of("drag");
  const HypothesisSpace now = SpaceOfRivals(
      first.With(SyntheticSpace::Noise(2) + 3 * first.Of("drag")), {"drag", "mass_damping"});
  PlannedColumns planned{Eigen::MatrixXd::Zero(SyntheticSpace::kRows, SyntheticSpace::kBase),
                         Eigen::MatrixXd(SyntheticSpace::kRows, 0),
                         {},
                         Eigen::MatrixXd::Zero(SyntheticSpace::kRows, 2)};
  planned.parameters.col(0) = 1e4 * first.Of("fibres");
  planned.variants.col(0) = 1e4 * first.Of("clock");
  const JoinedSpace space(now, planned);
  const FoundEffect drag{"drag", {kDrag}, Eigen::VectorXd::Zero(1)};

  const std::vector<int> known = {0, 1, kDrag}, shown = {0, kDrag};
  Eigen::Matrix3d precision = now.model.products()(known, known);
  precision(2, 2) += 1.0 / (20 * 20);
  const Eigen::Matrix3d posterior = precision.inverse();
  const Eigen::Vector3d mean = -posterior * now.model.toward()(known);
  const double deviation = std::sqrt(posterior(2, 2)), z = mean[2] / deviation;
  EXPECT_LT(z, 0);
  const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
  const double size = mean[2] + deviation * density / (0.5 * std::erfc(-z / std::numbers::sqrt2));
  const double parameter = mean[0] + posterior(0, 2) / posterior(2, 2) * (size - mean[2]);

  const Eigen::Matrix2d products =
      (space.joined().model.products() - now.model.products())(shown, shown);
  constexpr int kDraws = 4000;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int absent = 0;
  for (int k = 0; k < kDraws; ++k) {
    const Eigen::VectorXd drawn = space.DrawToward(drag, 7, static_cast<uint64_t>(k));
    const Eigen::Vector2d amounts =
        -products.inverse() * (drawn - now.model.toward())(shown).eval();
    sum += amounts;
    absent += amounts[1] < 1e-3 * deviation;
    EXPECT_GT(amounts[1], -1e-2 * deviation);
  }
  // Four standard errors; neither amount spreads more than without the truncation.
  EXPECT_NEAR(sum[1] / kDraws, size, 4 * deviation / std::sqrt(kDraws));
  EXPECT_NEAR(sum[0] / kDraws, parameter, 4 * std::sqrt(posterior(0, 0) / kDraws));
  EXPECT_LT(absent, kDraws / 50);
}

// A column of its own without a prior takes everything that it can explain.
TEST(JoinedSpace, LearnsNothingAlongAColumnWithoutAPrior) {
  TwoRecordings two;
  two.planned.own = two.second.Of("drag");
  two.planned.own_priors.assign(1, LinearPrior());
  const JoinedSpace space(two.now, two.planned);
  const FoundEffect drag = FindEffect(two.now, "drag");
  const int column = drag.columns[0];
  const HypothesisSpace& joined = space.joined();
  EXPECT_NEAR(joined.model.products()(column, column), two.now.model.products()(column, column),
              1e-9);
  EXPECT_EQ(joined.rows, 2 * SyntheticSpace::kRows - 1);
  const Eigen::VectorXd drawn = space.DrawToward(drag, 7, 0);
  EXPECT_NEAR(drawn[column], two.now.model.toward()[column], 1e-9);
}

// A second recording in which the rivals differ more tells them apart better than a repetition.
TEST(JoinedSpace, SeparatesRivalsThatThePlannedRecordingSeparates) {
  const TwoRecordings two;
  const PlannedColumns again{two.first.columns.leftCols(SyntheticSpace::kBase),
                             Eigen::MatrixXd(SyntheticSpace::kRows, 0),
                             {},
                             two.first.columns.middleCols(SyntheticSpace::kBase, 2)};
  const JoinedSpace repeated(two.now, again);
  const std::vector<FoundEffect> found = {FindEffect(two.now, "drag"),
                                          FindEffect(two.now, "mass_damping")};
  const auto lambda = [&](const JoinedSpace& space) {
    return SeparationsOf(space.joined(), found).front().lambda;
  };
  const double now = SeparationsOf(two.now, found).front().lambda;
  EXPECT_NEAR(lambda(repeated), 2 * now, 0.02 * now);
  EXPECT_GT(lambda(two.space), 3 * now);
}

}  // namespace
}  // namespace lacuna
