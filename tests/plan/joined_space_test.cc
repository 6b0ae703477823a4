#include "plan/joined_space.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "diagnosis/projected_hypotheses.h"
#include "diagnosis/synthetic_space.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;

TEST(SpaceOfEffects, KeepsTheBaseAndTheEffects) {
  const SyntheticSpace synthetic;
  const HypothesisSpace all = synthetic.With(SyntheticSpace::Noise(1) - 9 * synthetic.Of("fibres"));
  const HypothesisSpace rivals = SpaceOfEffects(all, {"fibres", "mass_damping"});
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

PlannedRival Rival(const std::vector<std::string>& effects) {
  PlannedRival rival;
  rival.effect = effects.size() == 2 ? effects[0] + " with " + effects[1] : effects[0];
  rival.effects = effects;
  return rival;
}

// Drag has a second variant, which stands behind the other effects.
TEST(SpaceOfRivals, CombinesTheVariantsOfAPair) {
  SyntheticSpace synthetic;
  synthetic.hypotheses[0].selection_penalty = 0.5;
  synthetic.hypotheses[2].selection_penalty = 0.25;
  synthetic.Add(HypothesisKind::kEffect, "drag", synthetic.Of("fibres"));
  const HypothesisSpace effects =
      SpaceOfEffects(synthetic.With(SyntheticSpace::Noise(1)), {"drag", "gravity"});
  const HypothesisSpace rivals =
      SpaceOfRivals(effects, {Rival({"gravity"}), Rival({"drag", "gravity"})});
  ASSERT_EQ(rivals.hypotheses.size(), 3u);
  EXPECT_EQ(rivals.hypotheses[0].name, "gravity");
  EXPECT_THAT(rivals.hypotheses[0].columns, ElementsAre(3, 4, 5));
  EXPECT_EQ(rivals.hypotheses[1].name, "drag with gravity");
  EXPECT_THAT(rivals.hypotheses[1].columns, ElementsAre(2, 3, 4, 5));
  EXPECT_EQ(rivals.hypotheses[1].selection_penalty, 0.75);
  EXPECT_EQ(rivals.hypotheses[2].name, "drag with gravity");
  EXPECT_THAT(rivals.hypotheses[2].columns, ElementsAre(6, 3, 4, 5));
  EXPECT_EQ(rivals.model.products(), effects.model.products());
}

// Both are missing: the pair has more evidence than either, and its columns give both sizes.
TEST(SpaceOfRivals, WeighsAPairWithTheColumnsOfBothEffects) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd residual =
      SyntheticSpace::Noise(3) - 15 * synthetic.Of("drag") - 12 * synthetic.Of("fibres");
  const HypothesisSpace rivals =
      SpaceOfRivals(SpaceOfEffects(synthetic.With(residual), {"drag", "fibres"}),
                    {Rival({"drag"}), Rival({"fibres"}), Rival({"drag", "fibres"})});
  const ProjectedHypotheses beside(rivals);
  const Eigen::VectorXd factors = beside.FactorsOfResidual();
  EXPECT_GT(factors[2], factors[0] + 10);
  EXPECT_GT(factors[2], factors[1] + 10);
  const FoundEffect pair = FindEffect(rivals, "drag with fibres");
  ASSERT_EQ(pair.amounts.size(), 2);
  EXPECT_NEAR(pair.amounts[0], 15, 5);  // the noise moves each by about 1
  EXPECT_NEAR(pair.amounts[1], 12, 5);
}

// A pair contains each of its effects, which can therefore be told from it in one direction only:
// by what the pair predicts beyond everything that the effect and the base can.
TEST(SpaceOfRivals, SeparatesAPairFromItsEffects) {
  const SyntheticSpace synthetic;
  const HypothesisSpace rivals =
      SpaceOfRivals(SpaceOfEffects(synthetic.With(SyntheticSpace::Noise(4)), {"drag", "fibres"}),
                    {Rival({"drag"}), Rival({"drag", "fibres"})});
  const FoundEffect alone{"drag", {2}, Eigen::VectorXd::Constant(1, 9)};
  const FoundEffect pair{"drag with fibres", {2, 3}, Eigen::Vector2d(5, 7)};
  Eigen::MatrixXd known(SyntheticSpace::kRows, SyntheticSpace::kBase + 1);
  known << synthetic.columns.leftCols(SyntheticSpace::kBase), synthetic.Of("drag");
  const Eigen::VectorXd beyond = 7 * synthetic.Of("fibres");
  const double expected =
      (beyond - known * known.householderQr().solve(beyond).eval()).squaredNorm();
  EXPECT_GT(expected, 20);
  for (const std::vector<FoundEffect>& order :
       {std::vector<FoundEffect>{alone, pair}, std::vector<FoundEffect>{pair, alone}}) {
    const std::vector<RecordedSeparation> found = SeparationsOf(rivals, order);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].lambda, expected, 1e-8 * expected);
  }
}

// Drag can only be positive, and the residual asks for a negative one. The evidence of the pair is
// the integral over its positive amounts of the evidence of the fibres beside each of them.
TEST(SpaceOfRivals, TruncatesAPositiveAmountOfAPair) {
  constexpr int kDrag = 2, kFibres = 3;
  constexpr double kPrior = 20;  // SyntheticSpace
  SyntheticSpace synthetic;
  synthetic.priors[kDrag].positive = true;
  synthetic.columns.col(synthetic.hypotheses[3].columns[0]) +=
      0.5 * synthetic.Of("drag");  // the fibres resemble drag
  const Eigen::VectorXd residual = SyntheticSpace::Noise(5) + 4 * synthetic.Of("drag");
  const HypothesisSpace rivals =
      SpaceOfRivals(SpaceOfEffects(synthetic.With(residual), {"drag", "fibres"}),
                    {Rival({"fibres"}), Rival({"drag", "fibres"})});
  const ProjectedHypotheses beside(rivals);
  const Eigen::VectorXd toward = beside.Project(rivals.model.toward());
  const Eigen::VectorXd factors = beside.LogBayesFactors(toward);
  ASSERT_NE(beside.products()(kDrag, kFibres), 0);

  constexpr int kSteps = 4000;
  constexpr double kLargest = 40, kStep = kLargest / kSteps;
  double sum = 0;
  for (int k = 0; k < kSteps; ++k) {
    const double amount = (k + 0.5) * kStep;
    const double prior = 2 * std::exp(-0.5 * amount * amount / (kPrior * kPrior)) /
                         (kPrior * std::sqrt(2 * std::numbers::pi));
    const double misfit =
        2 * amount * toward[kDrag] + amount * amount * beside.products()(kDrag, kDrag);
    const Eigen::VectorXd left = toward + amount * beside.products().col(kDrag);
    sum += kStep * prior * std::exp(beside.LogBayesFactors(left)[0] - 0.5 * misfit);
  }
  EXPECT_NEAR(factors[1], std::log(sum), 1e-3);
  const size_t pair = 1;
  const Eigen::VectorXd amounts = beside.AmountsOf(pair, toward).value;
  EXPECT_EQ(amounts[0], 0) << "as the data ask for a negative one";
  EXPECT_NEAR(amounts[1], beside.AmountsOf(0, toward).value[0], 1e-9) << "as without drag";
}

// Two recordings. The second has a column of its own, which resembles an effect and has a prior
// that allows it an amount about as large as the noise.
struct TwoRecordings {
  SyntheticSpace first{0.3}, second{1.5};
  HypothesisSpace now = SpaceOfEffects(first.With(SyntheticSpace::Noise(2) - 9 * first.Of("drag")),
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
  const HypothesisSpace now = SpaceOfEffects(
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

// Two alike effects at once, which can only be positive: the recordings know their sum better than
// their difference. They and a parameter have the mean and the spread of those draws from the
// posterior in which both are positive. The planned recording shows them without noise that counts.
TEST(JoinedSpace, DrawsTwoAlikePositiveAmountsTogether) {
  constexpr int kDrag = SyntheticSpace::kBase, kMassDamping = kDrag + 1;
  SyntheticSpace first(0.1);
  first.priors[kDrag].positive = first.priors[kMassDamping].positive = true;
  first.columns.col(0) += 0.5 * first.Of("drag");
  const HypothesisSpace now = SpaceOfEffects(
      first.With(SyntheticSpace::Noise(2) - 5 * first.Of("drag") - 5 * first.Of("mass_damping")),
      {"drag", "mass_damping"});
  PlannedColumns planned{Eigen::MatrixXd::Zero(SyntheticSpace::kRows, SyntheticSpace::kBase),
                         Eigen::MatrixXd(SyntheticSpace::kRows, 0),
                         {},
                         Eigen::MatrixXd(SyntheticSpace::kRows, 2)};
  planned.parameters.col(0) = 1e4 * first.Of("gravity").col(0);
  planned.variants << 1e4 * first.Of("clock"), 1e4 * first.Of("fibres");
  const JoinedSpace space(now, planned);
  const FoundEffect both{"both", {kDrag, kMassDamping}, Eigen::Vector2d::Zero()};

  const std::vector<int> known = {0, 1, kDrag, kMassDamping}, shown = {0, kDrag, kMassDamping};
  Eigen::Matrix4d precision = now.model.products()(known, known);
  precision.diagonal().tail<2>().array() += 1.0 / (20 * 20);
  const Eigen::Matrix4d posterior = precision.inverse();
  const Eigen::Vector4d mean = -posterior * now.model.toward()(known);
  EXPECT_LT(posterior(2, 3), -0.9 * std::sqrt(posterior(2, 2) * posterior(3, 3)));
  // Of the parameter, the two amounts and their sum.
  struct Moments {
    void Add(const Eigen::Vector3d& amounts) {
      const Eigen::Vector4d all(amounts[0], amounts[1], amounts[2], amounts[1] + amounts[2]);
      sum += all;
      squares += all.cwiseAbs2();
      ++count;
    }
    Eigen::Array4d Mean() const { return sum / count; }
    Eigen::Array4d Deviation() const { return (squares.array() / count - Mean().square()).sqrt(); }
    Eigen::Vector4d sum = Eigen::Vector4d::Zero(), squares = Eigen::Vector4d::Zero();
    int count = 0;
  };
  const Eigen::Matrix4d root = posterior.llt().matrixL();
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  Moments expected, found;
  for (int k = 0; k < 200000; ++k) {
    const Eigen::Vector4d amounts =
        mean + root * Eigen::Vector4d::NullaryExpr([&] { return normal(random); });
    if (amounts[2] > 0 && amounts[3] > 0) expected.Add(amounts({0, 2, 3}));
  }
  EXPECT_GT(expected.count, 20000);

  const Eigen::Matrix3d seen =
      (space.joined().model.products() - now.model.products())(shown, shown);
  constexpr int kDraws = 4000;
  for (int k = 0; k < kDraws; ++k) {
    const Eigen::VectorXd drawn = space.DrawToward(both, 7, static_cast<uint64_t>(k));
    const Eigen::Vector3d amounts = -seen.inverse() * (drawn - now.model.toward())(shown).eval();
    found.Add(amounts);
    EXPECT_GT(std::min(amounts[1], amounts[2]), -1e-3);
  }
  // More than four standard errors.
  const double error = 5 / std::sqrt(kDraws);
  for (int k = 0; k < 4; ++k) {
    const double deviation = expected.Deviation()[k];
    EXPECT_NEAR(found.Mean()[k], expected.Mean()[k], error * deviation) << k;
    EXPECT_NEAR(found.Deviation()[k], deviation, error * deviation) << k;
  }
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
