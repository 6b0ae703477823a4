#include "diagnosis/adequacy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/synthetic_space.h"

namespace lacuna {
namespace {

TEST(ProjectedHypotheses, GivesTheBayesFactorsOfTheLinearModels) {
  SyntheticSpace synthetic;
  synthetic.priors[2].positive = true;  // drag
  const Eigen::VectorXd residual =
      SyntheticSpace::Noise(1) - 9 * synthetic.Of("drag") - 3 * synthetic.columns.col(0);
  const HypothesisSpace space = synthetic.With(residual);
  const ProjectedHypotheses projected(space);
  const Eigen::VectorXd found = projected.LogBayesFactors(projected.Project(space.model.toward()));
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

// The Bayes factor of an unknown force is the mean over its prior widths.
TEST(ProjectedHypotheses, AveragesOverTheWidthsOfAnUnknownForce) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd residual = SyntheticSpace::Noise(2) + 4 * synthetic.unknown.rowwise().sum();
  const HypothesisSpace space = synthetic.With(residual);
  const ProjectedHypotheses projected(space);
  const double found =
      projected.LogBayesFactors(projected.Project(space.model.toward())).tail<1>()[0];
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
    return projected.LogBayesFactors(projected.Project(space.model.toward())).tail<1>()[0];
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
  EXPECT_EQ(TestAdequacy(noisy, {}, false, 1).p_variance, 1);
}

}  // namespace
}  // namespace lacuna
