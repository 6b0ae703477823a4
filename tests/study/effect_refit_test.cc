#include "study/effect_refit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "effects/catalogue.h"
#include "study/calibration_fits.h"
#include "study/held_bar.h"
#include "study/linear_misfit.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

constexpr int kFrames = 40, kSeries = 3;
constexpr double kSigma = 1e-4;  // m

// One recording of one marker: what is left looks like `amount` of the nuisance beside a wave.
FittedHypothesis MakeHypothesis(double amount) {
  LinearisedMisfit misfit;
  misfit.usable = true;
  LinearisedMisfit::Part part;
  part.layout.series = kSeries;
  part.layout.count.assign(kSeries * kFrames, 1);
  for (int frame = 0; frame < kFrames; ++frame) part.layout.times.push_back(0.01 * frame);
  part.errors.noise = kSigma;
  part.fitted.assign(kFrames, 1);
  const Eigen::Index rows = kSeries * kFrames;
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(rows, 0, 1);
  misfit.by.resize(rows, 2);
  misfit.by.col(0) = 1e-3 * (2 * std::numbers::pi * t).array().cos();
  misfit.by.col(1) = 1e-3 * t;
  misfit.residual = kSigma * (40 * t).array().sin();
  misfit.residual -= amount * misfit.by.col(1);
  misfit.parts.push_back(part);
  FittedHypothesis hypothesis;
  hypothesis.misfit = misfit;
  hypothesis.parameters = 1;
  hypothesis.priors = {{0, 1, false}, {0.1, 0.2, false}};
  hypothesis.left = misfit.residual;
  return hypothesis;
}

const NoiseLevel kNoise{0.008, 1.3};

// At the best parameters it is the evidence of the linear model; a parameter that is elsewhere
// loses what that costs.
TEST(HypothesisEvidence, IsThatOfTheLinearModelAtItsBest) {
  FittedHypothesis hypothesis = MakeHypothesis(0.8);
  const auto fit = [&] {
    const LinearisedMisfit& misfit = hypothesis.misfit;
    return LinearModel(WhitenedRows(misfit.residual, misfit, kNoise.correlation_time, false),
                       WhitenedRows(misfit.by, misfit, kNoise.correlation_time, false),
                       hypothesis.priors)
        .FitAll(kNoise.variance);
  };
  const LinearFit best = fit();
  EXPECT_LT(EvidenceOf(hypothesis, kNoise).log_evidence, best.log_evidence - 1e-6);
  hypothesis.misfit.residual += best.change[0] * hypothesis.misfit.by.col(0);
  hypothesis.priors[0].mean -= best.change[0];
  EXPECT_NEAR(EvidenceOf(hypothesis, kNoise).log_evidence, best.log_evidence, 1e-9);
}

// A nuisance takes its part of the misfit away, and is paid for by its prior.
TEST(HypothesisEvidence, PaysForTheNuisancesItUses) {
  const FittedHypothesis usual = MakeHypothesis(0.1), far = MakeHypothesis(0.9);
  const HypothesisEvidence of_usual = EvidenceOf(usual, kNoise), of_far = EvidenceOf(far, kNoise);
  EXPECT_LT(of_far.misfit, 1.05 * of_usual.misfit);
  // (0.8 / 0.2)² / 2 = 8, if the column fixes it.
  EXPECT_NEAR(of_usual.log_evidence - of_far.log_evidence, 8, 0.5);
}

// First order may expect a size at which everything is another motion, from where no fit finds
// back.
TEST(EffectRefit, IsNotWorseThanTheModelWithout) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study = ReadBarStudy(folder.Path());
  const CalibrationProblem problem(study, BarMesh({6, 2, 2}, 1));
  ProgressOptions silent;
  silent.style = ProgressStyle::kSilent;
  Progress progress(silent);
  const Calibration fit = FitFromStart(problem, &progress);
  ASSERT_FALSE(fit.estimates.empty()) << fit.message;
  const LinearisedMisfit misfit = problem.Linearise(fit.parameters, true);
  ASSERT_TRUE(misfit.usable) << misfit.message;

  ScoredEffect bed;
  bed.candidate = {"elastic_support", "", MakeEffect("elastic_support", {{"modulus", 0}}), {0}};
  bed.score.size = Eigen::VectorXd::Constant(1, 3e6);  // Pa/m: it stops the bar altogether
  bed.fitted = fit.parameters;
  const EffectRefit refit =
      Refit(problem, fit.parameters, &bed, {Eigen::MatrixXd(misfit.residual.size(), 0), {}, 0},
            misfit, false, &progress);
  ASSERT_TRUE(refit.message.empty()) << refit.message;
  // A refit ends where a step gains less than one standard deviation.
  EXPECT_LE(refit.calibration.rms, 1.05 * fit.rms);
  EXPECT_LT(refit.calibration.start_rms, 3 * fit.rms);
}

}  // namespace
}  // namespace lacuna
