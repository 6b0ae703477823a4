// Refits of effects beside a model of the held bar (support/held_bar.h).
#include "diagnosis/effect_refit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "calibration/calibration_fits.h"
#include "diagnosis/rank_effects.h"
#include "effects/catalogue.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// The bar that was held aside and released, with elements that are too coarse.
class OfACoarseBar : public ::testing::Test {
 protected:
  OfACoarseBar() {
    WriteBarRecording(folder_.Path(), FilmHeldBar({}));
    study_ = ReadBarStudy(folder_.Path());
    problem_.emplace(study_, BarMesh({6, 2, 2}, 1));
  }

  const TemporaryFolder folder_;
  PredictionStudy study_;
  std::optional<CalibrationProblem> problem_;
  SilentProgress progress_;
};
using EffectRankingOfACoarseBar = OfACoarseBar;

class EffectRefitOfACoarseBar : public OfACoarseBar {
 protected:
  void SetUp() override {
    fit_ = FitFromStart(*problem_, &progress_);
    ASSERT_FALSE(fit_.estimates.empty()) << fit_.message;
    misfit_ = problem_->Linearise(fit_.parameters, {.with_jacobian = true});
    ASSERT_TRUE(misfit_.usable) << misfit_.message;
    none_ = {Eigen::MatrixXd(misfit_.residual.size(), 0), {}, 0};
  }

  ScoredEffect Drag() const {
    ScoredEffect drag;
    drag.candidate = {"drag", "", MakeEffect("drag", {{"coefficient", 1}}), {0}};
    drag.score.size = Eigen::VectorXd::Constant(1, 1);
    drag.expected_values = fit_.parameters;
    return drag;
  }

  Calibration fit_;
  LinearisedMisfit misfit_;
  AdoptedNuisances none_;
};

// A bar that is softer near one end may look like one that is stiffer near the other, so a refit
// starts from both.
TEST_F(EffectRankingOfACoarseBar, KeepsThePlacesWithMoreEvidenceThanTheirNeighbours) {
  const EffectRanking ranking = RankEffects(*problem_, problem_->Start(), &progress_);
  int places = 0;
  for (const ScoredEffect& effect : ranking.effects) {
    std::vector<VariantPosition> kept{effect.candidate.position};
    double at_most = effect.score.evidence;
    for (const ScoredVariant& other : effect.elsewhere) {
      EXPECT_EQ(other.candidate.type, effect.candidate.type);
      EXPECT_NE(other.candidate.variant, effect.candidate.variant);
      EXPECT_GT(other.candidate.position.line, 0);
      EXPECT_LE(other.score.evidence, at_most);
      at_most = other.score.evidence;
      // Of two places side by side, only one can be better than all of its neighbours.
      for (const VariantPosition& better : kept)
        EXPECT_FALSE(other.candidate.position.line == better.line &&
                     std::abs(other.candidate.position.number - better.number) < 2)
            << effect.candidate.type;
      kept.push_back(other.candidate.position);
    }
    places += static_cast<int>(effect.elsewhere.size());
  }
  const ScoredEffect* fibres = ranking.Find("fibre_stiffness");
  ASSERT_NE(fibres, nullptr);
  EXPECT_TRUE(fibres->elsewhere.empty());
  EXPECT_GT(places, 0);
}

// First order may predict a size at which the motion is entirely different, and from which no fit
// would return.
TEST_F(EffectRefitOfACoarseBar, IsNotWorseThanTheModelWithoutTheEffect) {
  ScoredEffect bed;
  bed.candidate = {"elastic_support", "", MakeEffect("elastic_support", {{"modulus", 0}}), {0}};
  bed.score.size = Eigen::VectorXd::Constant(1, 3e6);  // Pa/m: the bar cannot move
  bed.expected_values = fit_.parameters;
  BaselineModel baseline{*problem_, fit_.parameters, misfit_, &progress_};
  const EffectRefit refit = Refit({baseline, none_}, &bed);
  ASSERT_TRUE(refit.message.empty()) << refit.message;
  // The modulus of the bed must be positive. It follows the parameters that the model had before.
  const std::vector<int>& positive = refit.hypothesis.positive;
  EXPECT_EQ(std::count(positive.begin(), positive.end(), study_.fitted.size()), 1);
  // A refit ends when a step gains less than one standard deviation.
  EXPECT_LE(refit.calibration.rms, 1.05 * fit_.rms);
  EXPECT_LT(refit.calibration.start_rms, 3 * fit_.rms);

  // An unknown error of u = 2 standard deviations of the noise makes the interval √(1 + u²) times
  // as wide, or less where the residual that is left has widened it already. The size must be
  // positive.
  baseline.model_error = 2;
  const ParameterEstimate size = refit.sizes.front();
  const ParameterEstimate wider = Refit({baseline, none_}, &bed).sizes.front();
  const double factor = std::hypot(1, 2 / std::max(1.0, refit.calibration.rms));
  EXPECT_EQ(wider.value, size.value);
  EXPECT_NEAR(wider.high - wider.value, factor * (size.high - size.value), 1e-9 * wider.high);
}

// Columns that were computed along another motion take their part of the residual, and the
// parameters follow. The same columns change little.
TEST_F(EffectRefitOfACoarseBar, IsFittedAnewBesideOtherNuisances) {
  const ScoredEffect drag = Drag();
  const BaselineModel baseline{*problem_, fit_.parameters, misfit_, &progress_};
  const EffectRefit refit = Refit({baseline, none_}, &drag);
  ASSERT_TRUE(refit.message.empty()) << refit.message;
  const NoiseLevel white{0, 1};
  const RefitEvidence before = EvidenceOf(refit, white);
  const auto beside = [&](const AdoptedNuisances& nuisances) {
    return RefitFromValues({baseline, nuisances}, &drag, refit.values_at_fit);
  };

  const RefitEvidence same = EvidenceOf(beside(none_), white);
  EXPECT_NEAR(same.all, before.all, 0.01 * before.misfit);

  // A column that explains the residual as it is.
  const AdoptedNuisances errors{refit.hypothesis.misfit.residual, {{-1, 0.01, false}}, 1};
  const EffectRefit explained = beside(errors);
  EXPECT_LT(EvidenceOf(explained, white).misfit, 0.01 * before.misfit);
  EXPECT_GT(EvidenceOf(explained, white).all, before.all + 0.45 * before.misfit);
  EXPECT_EQ(explained.hypothesis.misfit.jacobian.cols(), explained.hypothesis.parameters + 1);
  // A column that pushes the model by one per cent of a parameter, which returns.
  const Eigen::VectorXd pushed =
      0.01 * fit_.parameters[0] * refit.hypothesis.misfit.jacobian.col(0);
  const EffectRefit moved = beside({pushed, {{1, 1e-3, false}}, 1});
  EXPECT_NEAR(EvidenceOf(moved, white).misfit, before.misfit, 0.02 * before.misfit);
  // Values beyond a bound start there.
  Eigen::VectorXd beyond = refit.values_at_fit;
  beyond[refit.baseline_values.size()] = -1;  // the coefficient, which must not be negative
  EXPECT_TRUE(RefitFromValues({baseline, none_}, &drag, beyond).message.empty());
}

// The search is given up after its first steps, as one that another effect has beaten.
TEST_F(EffectRefitOfACoarseBar, SaysWhyItHasNotConverged) {
  const ScoredEffect drag = Drag();
  const BaselineModel baseline{*problem_, fit_.parameters, misfit_, &progress_};
  const ExtendedProblem extended(baseline, &drag, none_);
  Eigen::VectorXd far = extended.problem().Start();
  far.head(2) = fit_.parameters.head(2);
  far[0] *= 30;
  const EffectRefit refit =
      RefitFromValues({baseline, none_}, &drag, far, -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(refit.message.empty()) << refit.message;
  EXPECT_NE(refit.unconverged.find("would not come close enough"), std::string::npos)
      << refit.unconverged;
}

// At the other end of its range, at 0, the drag vanishes.
TEST_F(EffectRefitOfACoarseBar, IsAtTheLimitOnlyWhereItsSizeIsLargest) {
  const ScoredEffect drag = Drag();
  const BaselineModel baseline{*problem_, fit_.parameters, misfit_, &progress_};
  const ExtendedProblem extended(baseline, &drag, none_);
  const std::vector<CalibratedParameter>& parameters = extended.problem().parameters();
  const size_t own = study_.fitted.size();
  const auto at_limit = [&](double value, Determination determination) {
    Calibration calibration;
    calibration.estimates.resize(parameters.size());
    calibration.estimates[own].value = value;
    calibration.estimates[own].determination = determination;
    return extended.SizesAtLimit(calibration);
  };
  const double most = parameters[own].max;
  EXPECT_EQ(at_limit(most, Determination::kAtBound), std::vector<bool>{true});
  EXPECT_EQ(at_limit(0.5 * most, Determination::kPinnedDown), std::vector<bool>{false});
  EXPECT_EQ(at_limit(parameters[own].min, Determination::kAtBound), std::vector<bool>{false});
}

TEST_F(EffectRefitOfACoarseBar, IsNotSettledWhereItEndsAboveAHopelessCost) {
  const ScoredEffect drag = Drag();
  const BaselineModel baseline{*problem_, fit_.parameters, misfit_, &progress_};
  const EffectRefit refit = Refit({baseline, none_}, &drag);
  ASSERT_TRUE(refit.calibration.usable) << refit.unconverged;
  EXPECT_EQ(refit.unconverged, "");
  // The search has converged where it starts.
  const EffectRefit again =
      RefitFromValues({baseline, none_}, &drag, refit.calibration.parameters, 0);
  ASSERT_TRUE(again.calibration.usable) << again.unconverged;
  EXPECT_NE(again.unconverged.find("too far from the measurements"), std::string::npos)
      << again.unconverged;
  EXPECT_EQ(again.values_at_fit, again.calibration.parameters);
  EXPECT_EQ(again.at_fit.misfit.residual, again.hypothesis.misfit.residual);
}

// The progress has a line for each prediction of a fit, and none for those that compare starts.
TEST_F(EffectRefitOfACoarseBar, CountsThePredictionsThatFindItsStart) {
  const ScoredEffect drag = Drag();
  const auto predictions = [&](RefitFrom from, int* of_fits) {
    std::ostringstream lines;
    Progress progress({.style = ProgressStyle::kJsonLines, .json_interval = 0, .stream = &lines});
    const BaselineModel baseline{*problem_, fit_.parameters, misfit_, &progress};
    const EffectRefit refit = Refit({baseline, none_}, &drag, {.from = from});
    const std::string text = lines.str();
    *of_fits = 0;
    for (size_t at = text.find("\"progress\""); at != std::string::npos;
         at = text.find("\"progress\"", at + 1))
      ++*of_fits;
    return refit.calibration.predictions;
  };
  int of_fits = 0;
  EXPECT_EQ(predictions(RefitFrom::kFixedSize, &of_fits), of_fits);
  EXPECT_GT(of_fits, 4);  // of three fits with the effect held, and one without
  // The expected values are the baseline's own, which are predicted once.
  const int all = predictions(RefitFrom::kFirstOrder, &of_fits);
  EXPECT_GE(all, of_fits + 1);
  EXPECT_LE(all, of_fits + 5);
}

}  // namespace
}  // namespace lacuna
