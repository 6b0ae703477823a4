#include "plan/joined_space.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

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
  const Eigen::VectorXd factors = before.LogBayesFactors(before.Project(all.model.toward()));
  const Eigen::VectorXd kept = after.LogBayesFactors(after.Project(rivals.model.toward()));
  EXPECT_NEAR(kept[0], factors[1], 1e-9);
  EXPECT_NEAR(kept[1], factors[3], 1e-9);
}

// Two recordings, the second with one more column of its own.
struct TwoRecordings {
  SyntheticSpace first{0.3}, second{1.5};
  Eigen::MatrixXd own = second.Of("clock");
  HypothesisSpace now = SpaceOfRivals(first.With(SyntheticSpace::Noise(2) - 9 * first.Of("drag")),
                                      {"drag", "mass_damping"});
  PlannedColumns planned{second.columns.leftCols(SyntheticSpace::kBase),
                         own,
                         {{0, 3, false}},
                         second.columns.middleCols(SyntheticSpace::kBase, 2)};
  JoinedSpace space{now, planned};
};

TEST(JoinedSpace, HasTheProductsOfBothRecordings) {
  const TwoRecordings two;
  constexpr Eigen::Index kRows = SyntheticSpace::kRows;
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(2 * kRows, 5);
  columns.topLeftCorner(kRows, 2) = two.first.columns.leftCols(2);
  columns.topRightCorner(kRows, 2) = two.first.columns.middleCols(2, 2);
  columns.bottomRows(kRows) << two.planned.parameters, two.own, two.planned.variants;
  const HypothesisSpace& joined = two.space.joined();
  EXPECT_TRUE(joined.model.products().isApprox(columns.transpose() * columns, 1e-12));
  EXPECT_THAT(joined.base, ElementsAre(0, 1, 2));
  EXPECT_THAT(joined.hypotheses[1].columns, ElementsAre(4));
  EXPECT_EQ(joined.model.Prior(2).deviation, 3);
  EXPECT_EQ(joined.rows, 2 * kRows);
  EXPECT_EQ(joined.model.toward()[2], 0);  // no measurements yet
  EXPECT_EQ(joined.model.toward()[3], two.now.model.toward()[2]);
  EXPECT_THAT(two.space.InJoined(FindEffect(two.now, "drag")).columns, ElementsAre(3));
}

// The mean and the covariance of the products of the planned rows alone.
TEST(JoinedSpace, DrawsFromThePredictiveDistribution) {
  const TwoRecordings two;
  const FoundEffect drag = FindEffect(two.now, "drag");
  const std::vector<int> known = {0, 1, drag.columns[0]};
  Eigen::Matrix3d precision = two.now.model.products()(known, known);
  precision(2, 2) += 1.0 / (20 * 20);
  const Eigen::Matrix3d covariance = precision.inverse();
  const Eigen::Vector3d mean = -covariance * two.now.model.toward()(known);
  Eigen::MatrixXd columns(SyntheticSpace::kRows, 5);
  columns << two.planned.parameters, two.own, two.planned.variants;
  const Eigen::MatrixXd products = columns.transpose() * columns;
  const Eigen::MatrixXd by_amounts = products(Eigen::all, std::vector<int>{0, 1, 3});
  const Eigen::VectorXd expected = -by_amounts * mean;
  const Eigen::MatrixXd spread = products + by_amounts * covariance * by_amounts.transpose();

  constexpr int kDraws = 20000;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(5);
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(5, 5);
  for (int k = 0; k < kDraws; ++k) {
    const Eigen::VectorXd drawn =
        two.space.DrawToward(drag, 7, static_cast<uint64_t>(k)) - two.space.joined().model.toward();
    sum += drawn;
    squares += (drawn - expected) * (drawn - expected).transpose();
  }
  for (int k = 0; k < 5; ++k) {
    const double deviation = std::sqrt(spread(k, k));
    EXPECT_NEAR(sum[k] / kDraws, expected[k], 4 * deviation / std::sqrt(kDraws)) << k;
    for (int j = 0; j < 5; ++j)
      EXPECT_NEAR(squares(k, j) / kDraws, spread(k, j),
                  6 * deviation * std::sqrt(spread(j, j)) / std::sqrt(kDraws))
          << k << " " << j;
  }
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
    return SeparationsOf(space.joined(), {space.InJoined(found[0]), space.InJoined(found[1])})
        .front()
        .lambda;
  };
  const double now = SeparationsOf(two.now, found).front().lambda;
  EXPECT_NEAR(lambda(repeated), 2 * now, 0.02 * now);
  EXPECT_GT(lambda(two.space), 3 * now);
}

}  // namespace
}  // namespace lacuna
