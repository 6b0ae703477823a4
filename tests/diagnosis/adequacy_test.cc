#include "diagnosis/adequacy.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/synthetic_space.h"

namespace lacuna {
namespace {

// A SyntheticSpace whose base has forty nuisances as well, which have finite priors and resemble
// the unknown force.
struct SpaceWithNuisances {
  static constexpr int kNuisances = 40;
  static constexpr double kDeviation = 2;  // of their amounts

  SpaceWithNuisances() {
    constexpr Eigen::Index kRows = SyntheticSpace::kRows;
    nuisances.resize(kRows, kNuisances);
    for (int k = 0; k < kNuisances; ++k)
      for (Eigen::Index row = 0; row < kRows; ++row)
        nuisances(row, k) =
            synthetic.unknown(row, k % synthetic.unknown.cols()) +
            Normal(RandomBits({8, static_cast<uint64_t>(k), static_cast<uint64_t>(row)})) /
                std::sqrt(static_cast<double>(kRows));
    columns.resize(kRows, synthetic.columns.cols() + kNuisances);
    columns << synthetic.columns.leftCols(SyntheticSpace::kBase), nuisances,
        synthetic.columns.rightCols(synthetic.columns.cols() - SyntheticSpace::kBase);
    priors.insert(priors.begin() + SyntheticSpace::kBase, kNuisances, {0, kDeviation, false});
    for (WeighedHypothesis& hypothesis : hypotheses)
      for (int& column : hypothesis.columns) column += kNuisances;
  }

  HypothesisSpace With(const Eigen::VectorXd& residual) const {
    return MakeHypothesisSpace(residual, columns, priors, kBase, hypotheses, 1,
                               SyntheticSpace::kRows);
  }

  // Noise, and the nuisances with amounts from their priors.
  Eigen::VectorXd Residual(uint64_t seed) const {
    Eigen::VectorXd amounts(kNuisances);
    for (int k = 0; k < kNuisances; ++k)
      amounts[k] = kDeviation * Normal(RandomBits({seed, 50, static_cast<uint64_t>(k)}));
    return SyntheticSpace::Noise(1000 + seed) - nuisances * amounts;
  }

  static constexpr int kBase = SyntheticSpace::kBase + kNuisances;
  SyntheticSpace synthetic;
  Eigen::MatrixXd nuisances, columns;
  std::vector<LinearPrior> priors = synthetic.priors;
  std::vector<WeighedHypothesis> hypotheses = synthetic.hypotheses;
};

// The largest distance of the distribution of the values from the uniform one (Kolmogorov and
// Smirnov).
double DistanceFromUniform(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double count = static_cast<double>(values.size());
  double distance = 0;
  for (size_t k = 0; k < values.size(); ++k)
    distance = std::max({distance, values[k] - static_cast<double>(k) / count,
                         static_cast<double>(k + 1) / count - values[k]});
  return distance;
}

TEST(ProjectedHypotheses, GivesTheBayesFactorsOfTheLinearModels) {
  SyntheticSpace synthetic;
  synthetic.priors[2].positive = true;  // drag
  const Eigen::VectorXd residual =
      SyntheticSpace::Noise(1) - 9 * synthetic.Of("drag") - 3 * synthetic.columns.col(0);
  const HypothesisSpace space = synthetic.With(residual);
  const ProjectedHypotheses projected(space);
  const Eigen::VectorXd found = projected.FactorsOfResidual();
  const LinearGaussianModel model(residual, synthetic.columns, synthetic.priors);
  const double without = model.Fit(space.base, 1).log_evidence;
  for (size_t h = 0; h + 1 < space.hypotheses.size(); ++h) {
    std::vector<int> with = space.base;
    const std::vector<int>& own = space.hypotheses[h].columns;
    with.insert(with.end(), own.begin(), own.end());
    EXPECT_NEAR(found[static_cast<Eigen::Index>(h)], model.Fit(with, 1).log_evidence - without,
                1e-8)
        << space.hypotheses[h].name;
  }
  EXPECT_GT(found[0], 10);
  EXPECT_NEAR(projected.Misfit({space.model.squares(), space.model.toward()}),
              model.Fit(space.base, 1).misfit, 1e-8 * residual.squaredNorm());
  EXPECT_NEAR(projected.AmountsOf(0, projected.Project(space.model.toward())).value[0], 9, 3);
}

// By the covariance matrix of the residual, C = v I + B P Bᵀ.
TEST(ProjectedHypotheses, IntegratesOutTheTakenColumns) {
  const SpaceWithNuisances nuisances;
  HypothesisSpace space = nuisances.With(nuisances.Residual(3));
  space.variance = 1.7;
  const std::vector<int>& gravity = space.hypotheses[2].columns;
  const ProjectedHypotheses projected(space, gravity);
  const HypothesisSpace marginal = projected.Marginal();
  EXPECT_TRUE(marginal.base.empty());
  EXPECT_EQ(marginal.rows, SyntheticSpace::kRows - 2);
  Eigen::MatrixXd covariance =
      1.7 * Eigen::MatrixXd::Identity(SyntheticSpace::kRows, SyntheticSpace::kRows);
  // In place of no prior a very wide one, which leaves an error of about 1e-8.
  constexpr double kWide = 1e4;
  std::vector<int> taken = space.base;
  taken.insert(taken.end(), gravity.begin(), gravity.end());
  for (const int column : taken) {
    const double deviation = std::min(kWide, space.model.Prior(column).deviation);
    covariance += std::pow(deviation, 2) * nuisances.columns.col(column) *
                  nuisances.columns.col(column).transpose();
  }
  const Eigen::LDLT<Eigen::MatrixXd> factor(covariance);
  const Eigen::VectorXd residual = nuisances.Residual(3);
  const Eigen::VectorXd weighed = 1.7 * factor.solve(residual);
  EXPECT_NEAR(marginal.model.squares(), residual.dot(weighed), 1e-4);
  const std::vector<int>& force = space.hypotheses.back().columns;
  const Eigen::MatrixXd seen = nuisances.columns(Eigen::all, force);
  EXPECT_TRUE(marginal.model.toward()(force).isApprox(seen.transpose() * weighed, 1e-5));
  EXPECT_TRUE(marginal.model.products()(force, force)
                  .isApprox(1.7 * seen.transpose() * factor.solve(seen), 1e-5));
  for (const int column : taken) {
    EXPECT_EQ(marginal.model.toward()[column], 0);
    EXPECT_EQ(marginal.model.Square(column), 0);
  }
}

// The Bayes factor of an unknown force is the mean over its prior widths.
TEST(ProjectedHypotheses, AveragesOverTheWidthsOfAnUnknownForce) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd residual = SyntheticSpace::Noise(2) + 4 * synthetic.unknown.rowwise().sum();
  const HypothesisSpace space = synthetic.With(residual);
  const ProjectedHypotheses projected(space);
  const double found = projected.FactorsOfResidual().tail<1>()[0];
  double mean = 0;
  const double without = LinearGaussianModel(residual, synthetic.columns, synthetic.priors)
                             .Fit(space.base, 1)
                             .log_evidence;
  for (const double scale : kForceScales) {
    std::vector<LinearPrior> priors = synthetic.priors;
    std::vector<int> with = space.base;
    for (const int column : space.hypotheses.back().columns) {
      priors[static_cast<size_t>(column)].deviation = scale;
      with.push_back(column);
    }
    mean += std::exp(
                LinearGaussianModel(residual, synthetic.columns, priors).Fit(with, 1).log_evidence -
                without) /
            static_cast<double>(std::size(kForceScales));
  }
  EXPECT_NEAR(found, std::log(mean), 1e-6 * std::abs(found));
  EXPECT_GT(found, 20);
}

// A recording may show a force that is a thousandth of what a prior of the size of gravity expects.
// Such a force is found, and noise alone gives little evidence against one.
TEST(ProjectedHypotheses, FindsAForceThatIsSmallBesideGravity) {
  SyntheticSpace synthetic;
  const HypothesisSpace plain = synthetic.With(SyntheticSpace::Noise(2));
  for (const int column : plain.hypotheses.back().columns) synthetic.columns.col(column) *= 1000;
  const auto evidence = [&](const Eigen::VectorXd& residual) {
    const HypothesisSpace space = synthetic.With(residual);
    const ProjectedHypotheses projected(space);
    return projected.FactorsOfResidual().tail<1>()[0];
  };
  const Eigen::VectorXd noise = SyntheticSpace::Noise(2);
  EXPECT_GT(evidence(noise), -5);
  EXPECT_LT(evidence(noise), 1);
  EXPECT_GT(evidence(noise + 3 * synthetic.unknown.rowwise().sum()), 15);
}

// One frame that was selected from a hundred needs so much more evidence.
TEST(SumVariants, ChargesForASelection) {
  const SyntheticSpace synthetic;
  HypothesisSpace space = synthetic.With(SyntheticSpace::Noise(1));
  const Eigen::VectorXd factors =
      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(space.hypotheses.size()), 8);
  const auto of_clock = [&] {
    for (const NamedEvidence& named : SumVariants(space, factors))
      if (named.name == "clock") return named.evidence;
    return 0.0;
  };
  EXPECT_NEAR(of_clock(), 8, 1e-12);
  for (WeighedHypothesis& hypothesis : space.hypotheses)
    if (hypothesis.name == "clock") hypothesis.selection_penalty = std::log(100.0);
  EXPECT_NEAR(of_clock(), 8 - std::log(100.0), 1e-12);
}

TEST(NoiseDraws, HaveTheMomentsOfNoise) {
  const SyntheticSpace synthetic;
  HypothesisSpace space = synthetic.With(SyntheticSpace::Noise(3));
  space.variance = 2;
  const NoiseDraws noise(space);
  constexpr int kDraws = 4000;
  double squares = 0;
  Eigen::MatrixXd products =
      Eigen::MatrixXd::Zero(synthetic.columns.cols(), synthetic.columns.cols());
  for (int k = 0; k < kDraws; ++k) {
    const ResidualProducts draw = noise.Draw(5, static_cast<uint64_t>(k));
    squares += draw.squares / kDraws;
    products += draw.toward * draw.toward.transpose() / kDraws;
  }
  // Standard errors: 2·500·√(2/500)/√4000 = 1, and 2·√(2/4000) = 0.045 per element.
  EXPECT_NEAR(squares, 2.0 * SyntheticSpace::kRows, 5);
  EXPECT_LT((products - 2 * space.model.products()).cwiseAbs().maxCoeff(), 0.25);
}

// Under noise alone the tail probability is uniform.
TEST(Adequacy, RejectsNoiseAsOftenAsItsLevelSays) {
  const SyntheticSpace synthetic;
  constexpr int kRecordings = 200;
  int below = 0;
  for (int k = 0; k < kRecordings; ++k)
    below += TestAdequacy(synthetic.With(SyntheticSpace::Noise(100 + static_cast<uint64_t>(k))), {},
                          true, static_cast<uint64_t>(k))
                 .p < 0.1;
  // 20 are expected, with a standard deviation of 4.2.
  EXPECT_GT(below, 8);
  EXPECT_LT(below, 33);
}

// So it is if every model has nuisances whose amounts are known from their priors only: they
// contribute to the residual as noise does, and are no sign of something unknown.
TEST(Adequacy, ExpectsTheAmountsOfNuisancesThatTheirPriorsAllow) {
  const SpaceWithNuisances nuisances;
  constexpr int kRecordings = 150;
  std::vector<double> p, p_unknown_force, p_variance;
  for (uint64_t k = 0; k < kRecordings; ++k) {
    const AdequacyTest test = TestAdequacy(nuisances.With(nuisances.Residual(k)), {}, true, k);
    p.push_back(test.p);
    p_unknown_force.push_back(test.p_unknown_force);
    p_variance.push_back(test.p_variance);
  }
  // One in a hundred samples of uniform numbers is further away. Draws of noise alone give
  // distances of 0.38, 0.18 and 0.39.
  const double limit = 1.63 / std::sqrt(kRecordings);
  EXPECT_LT(DistanceFromUniform(p), limit);
  EXPECT_LT(DistanceFromUniform(p_unknown_force), limit);
  EXPECT_LT(DistanceFromUniform(p_variance), limit);
}

// The model error has its length beside the base, however much of its direction the base contains.
TEST(Adequacy, ExpectsTheModelErrorBesideTheBase) {
  const SpaceWithNuisances nuisances;
  constexpr double kModelError = 10;
  constexpr int kRecordings = 40;
  std::vector<std::vector<int>> along;  // the unknown force, then the effects
  for (const WeighedHypothesis& hypothesis : nuisances.hypotheses)
    if (hypothesis.kind != HypothesisKind::kNuisance) along.push_back(hypothesis.columns);
  std::rotate(along.begin(), along.end() - 1, along.end());
  const HypothesisSpace plain = nuisances.With(SyntheticSpace::Noise(0));
  const ProjectedHypotheses beside_base(plain);
  double mean = 0, mean_of_force = 0;
  for (uint64_t k = 0; k < kRecordings; ++k) {
    const std::vector<int>& own =
        along[k % 2 == 0 ? 0 : 1 + RandomBits({k, 51}) % (along.size() - 1)];
    Eigen::VectorXd amounts(static_cast<Eigen::Index>(own.size()));
    for (Eigen::Index j = 0; j < amounts.size(); ++j)
      amounts[j] = Normal(RandomBits({k, 52, static_cast<uint64_t>(j)}));
    amounts *= std::sqrt(2 * kModelError / amounts.dot(beside_base.products()(own, own) * amounts));
    HypothesisSpace space =
        nuisances.With(nuisances.Residual(k) + nuisances.columns(Eigen::all, own) * amounts);
    space.model_error = kModelError;
    const AdequacyTest test = TestAdequacy(space, {}, false, k);
    mean += test.p / kRecordings;
    mean_of_force += test.p_unknown_force / kRecordings;
  }
  // The standard deviation of these means is 0.05. An error that has its length before the base is
  // fitted gives 0.2 and 0.3.
  EXPECT_NEAR(mean, 0.5, 0.15);
  EXPECT_NEAR(mean_of_force, 0.5, 0.15);
}

// The variance is judged by the given noise, also where the hypotheses are weighed with more.
TEST(Adequacy, JudgesTheVarianceByTheGivenNoise) {
  const SpaceWithNuisances nuisances;
  HypothesisSpace space = nuisances.With(nuisances.Residual(3));
  const double given = TestAdequacy(space, {}, true, 1).found.variance;
  EXPECT_NEAR(given, 1, 0.2);  // its standard deviation is 0.06
  space.variance = 1.5;
  EXPECT_NEAR(TestAdequacy(space, {}, true, 1).found.variance, given, 1e-9);
  EXPECT_GT(std::abs(TestAdequacy(space, {}, false, 1).found.variance - given), 1e-3);
}

TEST(Adequacy, CountsWhatIsLeftAsEvidenceOrAsExcessOverTheNoise) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd noise = SyntheticSpace::Noise(4);
  const AdequacyTest force =
      TestAdequacy(synthetic.With(noise + 4 * synthetic.unknown.rowwise().sum()), {}, true, 1);
  EXPECT_EQ(force.left, 2 * force.found.unknown_force);
  EXPECT_GT(force.left, 50);
  // No force and no effect explains noise that is too large.
  const HypothesisSpace noisy = synthetic.With(1.3 * noise);
  const double freedom = SyntheticSpace::kRows - SyntheticSpace::kBase;
  const AdequacyTest known = TestAdequacy(noisy, {}, true, 1);
  EXPECT_NEAR(known.left, (known.found.variance - 1) * freedom, 1e-6);
  EXPECT_GT(known.left, 100);
  EXPECT_LT(TestAdequacy(noisy, {}, false, 1).left, 5);
}

// A statistic that cannot be computed has not been passed: it is no part of the test.
TEST(Adequacy, LeavesOutAForceThatCannotBeTried) {
  SyntheticSpace synthetic;
  const Eigen::VectorXd noise = SyntheticSpace::Noise(4);
  EXPECT_FALSE(std::isnan(TestAdequacy(synthetic.With(noise), {}, true, 1).p_unknown_force));
  synthetic.hypotheses.pop_back();
  const AdequacyTest quiet = TestAdequacy(synthetic.With(noise), {}, true, 1);
  EXPECT_TRUE(std::isnan(quiet.p_unknown_force));
  EXPECT_GT(quiet.p, 0.05);
  const AdequacyTest noisy = TestAdequacy(synthetic.With(1.3 * noise), {}, true, 1);
  EXPECT_TRUE(noisy.IsResidualRarest());
  EXPECT_LT(noisy.p, 0.01);
}

TEST(Adequacy, SeesAForceAnEffectAndTooMuchNoise) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd noise = SyntheticSpace::Noise(4);
  EXPECT_GT(TestAdequacy(synthetic.With(noise), {}, true, 1).p, 0.05);
  const AdequacyTest force =
      TestAdequacy(synthetic.With(noise + 4 * synthetic.unknown.rowwise().sum()), {}, true, 1);
  EXPECT_LT(force.p_unknown_force, 0.01);
  EXPECT_LT(force.p, 0.01);
  EXPECT_TRUE(force.IsSupported());
  // ... unless the discretisation may have left as much.
  HypothesisSpace coarse = synthetic.With(noise + 4 * synthetic.unknown.rowwise().sum());
  coarse.model_error = 1000;
  EXPECT_FALSE(TestAdequacy(coarse, {}, false, 1).IsSupported());
  const HypothesisSpace effect = synthetic.With(noise - 6 * synthetic.Of("fibres"));
  const AdequacyTest without = TestAdequacy(effect, {}, true, 1);
  EXPECT_LT(without.p_further, 0.01);
  EXPECT_EQ(without.found.best_further.name, "fibres");
  // With its columns in the model, only noise is left.
  EXPECT_GT(TestAdequacy(effect, effect.hypotheses[3].columns, true, 1).p, 0.05);
  const HypothesisSpace noisy = synthetic.With(1.3 * noise);
  EXPECT_LT(TestAdequacy(noisy, {}, true, 1).p_variance, 0.01);
  EXPECT_TRUE(TestAdequacy(noisy, {}, true, 1).IsSupported());
  EXPECT_TRUE(std::isnan(TestAdequacy(noisy, {}, false, 1).p_variance));
}

}  // namespace
}  // namespace lacuna
