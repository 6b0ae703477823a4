// What becomes of the refits of a diagnosis once there is another fit of the same effect.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "calibration/calibration_fits.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "diagnosis/effect_refit.h"
#include "diagnosis/nuisance_refits.h"
#include "diagnosis/pair_refit.h"
#include "diagnosis/refit_comparison.h"
#include "diagnosis/refits.h"
#include "diagnosis/refitted_ranking.h"
#include "diagnosis/variant_refit.h"
#include "effects/catalogue.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

constexpr NoiseLevel kWhite{0, 1};

// A bar that was held aside and released, with few elements.
class RefitsOfABar : public ::testing::Test {
 protected:
  void SetUp() override {
    WriteBarRecording(folder_.Path(), FilmHeldBar({}));
    study_ = ReadBarStudy(folder_.Path());
    problem_.emplace(study_, BarMesh({4, 1, 1}, 1));
    fit_ = FitFromStart(*problem_, &progress_);
    ASSERT_FALSE(fit_.estimates.empty()) << fit_.message;
    ranking_.misfit = problem_->Linearise(fit_.parameters, {.with_jacobian = true});
    ASSERT_TRUE(ranking_.misfit.usable) << ranking_.misfit.message;
    ranking_.adopted = {Eigen::MatrixXd(ranking_.misfit.residual.size(), 0), {}, 0};
    ranking_.noise = kWhite;
  }

  BaselineModel Model() { return {*problem_, fit_.parameters, ranking_.misfit, &progress_}; }

  ScoredEffect Scored(const std::string& type, const std::string& variant,
                      const std::map<std::string, double>& values) const {
    ScoredEffect effect;
    effect.candidate = {type, variant, MakeEffect(type, values), {0}};
    effect.score.size = Eigen::VectorXd::Constant(1, 1);
    effect.expected_values = fit_.parameters;
    return effect;
  }
  ScoredEffect Drag(const std::string& variant) const {
    return Scored("drag", variant, {{"coefficient", 1}});
  }
  ScoredEffect Support(const std::string& variant) const {
    return Scored("elastic_support", variant, {{"modulus", 0}});
  }

  // The model without an effect, and effects that have not been refitted.
  RefittedRanking RankedWith(const BaselineModel& model, const std::vector<ScoredEffect>& effects) {
    RefittedRanking ranked;
    ranked.baseline = Refit({model, ranking_.adopted}, nullptr);
    EXPECT_TRUE(ranked.baseline.message.empty()) << ranked.baseline.message;
    for (const ScoredEffect& effect : effects) ranked.effects.emplace_back().scored = effect;
    ranked.refits.resize(effects.size());
    return ranked;
  }

  EffectRefit RefitDrag(const BaselineModel& model) {
    const ScoredEffect drag = Drag("");
    EffectRefit refit = Refit({model, ranking_.adopted}, &drag);
    EXPECT_TRUE(refit.message.empty()) << refit.message;
    return refit;
  }

  EffectRefit RefitSupport(const BaselineModel& model) {
    const ScoredEffect support = Support("");
    EffectRefit refit = Refit({model, ranking_.adopted}, &support);
    EXPECT_TRUE(refit.message.empty()) << refit.message;
    return refit;
  }

  // A drag that is the best effect, and a support with a refit that is said to have converged, both
  // looked at along the motion with drag. `along`: the noise there.
  RefittedRanking LookedAlongDrag(const BaselineModel& model, EffectRefit support,
                                  const NoiseLevel& along) {
    RefittedRanking ranked = RankedWith(model, {Drag(""), Support("")});
    ranked.baseline.errors.has_held_out = false;
    ranked.Take(0, {Drag(""), RefitDrag(model)});
    support.unconverged.clear();
    ranked.Take(1, {Support(""), std::move(support)});
    ranked.baseline_evidence = EvidenceOf(ranked.refits[0], kWhite).all - 1000;
    ranked.best = {.effect = 0, .evidence = 1000};
    EffectRanking ranking;
    ranking.adopted = {1e-6 * ranking_.misfit.jacobian.col(0), {{0, 1, false}}, 1};
    ranking.noise = along;
    LookAlong({model, ranking_}, "drag", ranking, &ranked);
    return ranked;
  }

  const TemporaryFolder folder_;
  PredictionStudy study_;
  std::optional<CalibrationProblem> problem_;
  Calibration fit_;
  EffectRanking ranking_;
  SilentProgress progress_;
};

// A column that pushes the model by some standard deviations of a parameter, which gives way.
TEST_F(RefitsOfABar, AreDescribedAsTheyAreBesideTheColumnsOfAnotherMotion) {
  const BaselineModel model = Model();
  RefittedRanking ranked = RankedWith(model, {Drag("")});
  ranked.Take(0, {Drag(""), RefitDrag(model)});
  const EffectRefit before = ranked.refits[0];
  const ParameterEstimate& stiffness = before.calibration.estimates[0];
  const double push = 2 * (stiffness.high - stiffness.value);
  EffectRanking along;
  along.adopted = {push * before.hypothesis.misfit.jacobian.col(0), {{1, 1e-3, false}}, 1};
  LookAlong({model, ranking_}, "drag", along, &ranked);
  const EffectRefit& after = ranked.refits[0];
  const RankedEffect& drag = ranked.effects[0];
  ASSERT_TRUE(drag.HasUsableRefit()) << drag.refit_message;
  EXPECT_LT(drag.baseline_values[0], before.baseline_values[0] - 0.5 * push);
  EXPECT_GT(drag.baseline_values[0], before.baseline_values[0] - 2 * push);
  EXPECT_NEAR(after.values_at_fit[0], drag.baseline_values[0], 0.5 * push);
  EXPECT_EQ(drag.values, after.effect_values);
  EXPECT_EQ(drag.errors.without_nuisances, after.errors.without_nuisances);
  EXPECT_EQ(drag.sizes.front().value, after.calibration.parameters[drag.baseline_values.size()]);
}

TEST_F(RefitsOfABar, GiveWayToABetterOneAsAWhole) {
  const BaselineModel model = Model();
  RefittedRanking ranked = RankedWith(model, {Drag("")});
  const EffectRefit good = RefitDrag(model);
  EffectRefit poor = good;
  poor.hypothesis.misfit.residual *= 2;
  poor.sizes.front().value = 77;
  poor.unconverged = "it was ended";
  ranked.Take(0, {Drag(""), poor});
  EXPECT_EQ(ranked.effects[0].sizes.front().value, 77);
  RefitAgain({model, ranking_}, 0, good.values_at_fit, kWhite, &ranked);
  const RankedEffect& drag = ranked.effects[0];
  EXPECT_TRUE(drag.unconverged.empty()) << drag.unconverged;
  EXPECT_EQ(drag.sizes.front().value, ranked.refits[0].sizes.front().value);
  EXPECT_NE(drag.sizes.front().value, 77);
  EXPECT_GT(EvidenceOf(ranked.refits[0], kWhite).all, EvidenceOf(poor, kWhite).all);
  // A worse one changes nothing.
  EXPECT_FALSE(ranked.TakeIfBetter(0, {Drag(""), poor}, kWhite));
  EXPECT_NE(drag.sizes.front().value, 77);
}

// Where the whole motion has led to no usable fit, the early part of it may. An effect that no
// longer may be refitted stays as it was ranked.
TEST_F(RefitsOfABar, AreTriedAgainFromTheEarlyPartOfTheMotion) {
  const BaselineModel model = Model();
  RefittedRanking ranked = RankedWith(model, {Drag("whole"), Support("whole")});
  EffectRefit failed;
  failed.message = "the simulation has stopped";
  ranked.Take(0, {Drag("whole"), failed});
  ranked.count = ranked.limit = 1;
  std::vector<ScoredEffect> early{Drag("early"), Support("early")};
  for (ScoredEffect& effect : early) effect.score.evidence = 10;
  RefitAsRankedEarly({model, ranking_}, early, 2, &ranked);
  EXPECT_TRUE(ranked.IsUsable(0)) << ranked.effects[0].refit_message;
  EXPECT_EQ(ranked.effects[0].scored.candidate.variant, "early");
  EXPECT_EQ(ranked.effects[0].scored.score.evidence, 0) << "the score is that of all frames";
  EXPECT_FALSE(ranked.effects[1].refitted);
  EXPECT_EQ(ranked.effects[1].scored.candidate.variant, "whole");
  EXPECT_EQ(ranked.count, 1);
}

TEST_F(RefitsOfABar, PayForTheVariantsThatTheyCannotReach) {
  const BaselineModel model = Model();
  RefittedRanking ranked = RankedWith(model, {Drag("only one"), Drag("one of seven")});
  const EffectRefit refit = RefitDrag(model);
  ScoredVariant of_seven = Drag("one of seven");
  of_seven.selection_penalty = std::log(7);
  ranked.Take(0, {Drag("only one"), refit});
  ranked.Take(1, {of_seven, refit});
  WeighRefits({model, ranking_}, &ranked);
  EXPECT_NEAR(ranked.effects[0].evidence - ranked.effects[1].evidence, std::log(7), 1e-9);
  // They pay for the choice among both effects, too.
  EXPECT_EQ(ranked.effects[0].penalty_of_effects, SelectionPenalty(2));
}

// What the best refit was before has been found beside other columns.
TEST_F(RefitsOfABar, AreComparedWithTheBestOneBesideTheSameColumns) {
  const BaselineModel model = Model();
  RefittedRanking ranked = RankedWith(model, {Drag("")});
  ranked.baseline.errors.has_held_out = false;  // nothing is refuted
  ranked.Take(0, {Drag(""), RefitDrag(model)});
  ranked.baseline_evidence = EvidenceOf(ranked.refits[0], kWhite).all - 1000;
  ranked.best = {.effect = 0, .evidence = 1e6, .underrated = 1e6};
  ranked.failed_pairs = {{"drag", "gravity"}};  // beside the old columns
  EffectRanking along;
  along.adopted = ranking_.adopted;
  along.noise = kWhite;
  LookAlong({model, ranking_}, "drag", along, &ranked);
  ASSERT_TRUE(ranked.best.has_value());
  EXPECT_EQ(ranked.best->evidence,
            EvidenceOf(ranked.refits[0], kWhite).all - ranked.baseline_evidence);
  EXPECT_LT(ranked.best->evidence, 1e5);
  EXPECT_EQ(ranked.best->underrated, ranked.best->evidence);  // first order gives no evidence
  EXPECT_THAT(ranked.failed_pairs, testing::IsEmpty());
}

// A refit that is far behind, and that no change of its parameters brings near, is not predicted.
TEST_F(RefitsOfABar, StayWhereTheyAreIfTheyAreFarBehind) {
  const BaselineModel model = Model();
  EffectRefit behind = RefitSupport(model);
  ASSERT_TRUE(behind.message.empty());
  behind.at_fit.misfit.residual *= 10;
  behind.at_fit.misfit.jacobian.setZero();
  behind.hypothesis = behind.at_fit;
  const RefittedRanking ranked = LookedAlongDrag(model, behind, kWhite);
  const EffectRefit& stays = ranked.refits[1];
  EXPECT_THAT(stays.unconverged, testing::HasSubstr("too far behind"));
  EXPECT_EQ(stays.values_at_fit, behind.values_at_fit);
  EXPECT_EQ(stays.hypothesis.misfit.residual, behind.at_fit.misfit.residual);
  EXPECT_EQ(stays.at_fit.misfit.jacobian.cols(), stays.at_fit.parameters + 1);
}

// All that first order promises lies in the held-out frames, which a fit does not follow.
TEST_F(RefitsOfABar, StayWhereTheyAreIfAFitWouldNotComeClose) {
  const BaselineModel model = Model();
  EffectRefit behind = RefitSupport(model);
  ASSERT_TRUE(behind.message.empty());
  LinearisedMisfit& misfit = behind.at_fit.misfit;
  const Eigen::VectorXd column = misfit.jacobian.col(behind.at_fit.parameters - 1);
  const double push = 100 / RmsOverSigma(column, misfit);
  for (const LinearisedMisfit::Part& part : misfit.parts)
    for (size_t f = 0; f < part.fitted.size(); ++f) {
      const Eigen::Index first = part.first_row + static_cast<Eigen::Index>(f) * part.layout.series;
      auto rows = misfit.residual.segment(first, part.layout.series);
      if (part.fitted[f]) {
        rows *= 10;
        misfit.jacobian.middleRows(first, part.layout.series).setZero();
      } else {
        rows += push * column.segment(first, part.layout.series);
      }
    }
  behind.at_fit.residual = misfit.residual;
  behind.hypothesis = behind.at_fit;
  const RefittedRanking ranked = LookedAlongDrag(model, behind, kWhite);
  EXPECT_THAT(ranked.refits[1].unconverged, testing::HasSubstr("too far behind"));
  EXPECT_EQ(ranked.refits[1].values_at_fit, behind.values_at_fit);
}

// A refit that seems to be far behind, here a support with another stiffness, is fitted again if
// first order promises to bring it near.
TEST_F(RefitsOfABar, AreFittedAgainWhereTheyOnlySeemedFarBehind) {
  const BaselineModel model = Model();
  EffectRefit behind = RefitSupport(model);
  ASSERT_TRUE(behind.message.empty());
  // As a column of its Jacobian says, a change of the last parameter by so much.
  const Eigen::Index last = behind.at_fit.parameters - 1;
  const auto push = [&](FittedHypothesis* hypothesis) {
    const Eigen::VectorXd column = hypothesis->misfit.jacobian.col(last);
    const double rms = RmsOverSigma(column, hypothesis->misfit);
    hypothesis->misfit.residual += 100 / rms * column;
  };
  push(&behind.at_fit);
  push(&behind.hypothesis);
  // The noise is another one than that in which refits are compared.
  const RefittedRanking ranked = LookedAlongDrag(model, behind, {0, 4});
  const EffectRefit& again = ranked.refits[1];
  ASSERT_TRUE(ranked.IsUsable(1)) << ranked.effects[1].refit_message;
  EXPECT_EQ(again.unconverged, "");
  EXPECT_EQ(again.hypothesis.misfit.jacobian.cols(), again.hypothesis.parameters + 1);
  EXPECT_EQ(again.at_fit.misfit.jacobian.cols(), again.at_fit.parameters + 1);
  ASSERT_TRUE(ranked.best.has_value());
  EXPECT_EQ(ranked.best->effect, 1u);  // the support explains more than drag
}

// The fit of drag is given up after its first steps. That first order says the same of it decides
// whether another variant is tried.
TEST_F(RefitsOfABar, AreNotRepeatedWhereTheFitAndFirstOrderAreHopeless) {
  Eigen::VectorXd far = fit_.parameters;
  far[0] *= 30;
  const LinearisedMisfit misfit = problem_->Linearise(far, {.with_jacobian = true});
  ASSERT_TRUE(misfit.usable) << misfit.message;
  ScoredEffect drag = Drag("here");
  drag.expected_values = far;
  drag.elsewhere = {drag};
  EffectRefit without;
  without.message = "not needed";
  without.errors.without_nuisances = 1e9;  // the refit predicts better
  const auto fits = [&](bool is_far_ahead) {
    std::ostringstream lines;
    Progress progress({.style = ProgressStyle::kJsonLines, .stream = &lines});
    const BaselineModel model{*problem_, far, misfit, &progress};
    const VariantRefit refit =
        RefitEffect({model, ranking_}, ranking_.adopted, without, /*is_found=*/true, drag,
                    {-std::numeric_limits<double>::infinity(), is_far_ahead});
    EXPECT_FALSE(refit.refit.calibration.usable);
    const std::string text = lines.str();
    int begun = 0;
    for (size_t at = text.find("\"begin\""); at != std::string::npos;
         at = text.find("\"begin\"", at + 1))
      ++begun;
    return begun;
  };
  EXPECT_EQ(fits(/*is_far_ahead=*/false), 2);
  EXPECT_EQ(fits(/*is_far_ahead=*/true), 1);
}

// With a thread for it, the second start is looked for during the first fit.
TEST_F(RefitsOfABar, FromTwoStartsDoNotDependOnTheNumberOfThreads) {
  const BaselineModel model = Model();
  const ScoredEffect drag = Drag("");
  const int before = ThreadCount();
  const auto refit = [&](int threads) {
    SetThreadCount(threads);
    return Refit({model, ranking_.adopted}, &drag, {.is_far_off = true});
  };
  const EffectRefit one = refit(1), two = refit(2);
  SetThreadCount(before);
  ASSERT_TRUE(one.message.empty()) << one.message;
  EXPECT_EQ(one.calibration.parameters, two.calibration.parameters);
  EXPECT_EQ(one.calibration.predictions, two.calibration.predictions);
}

// Each of the three comparisons of a pair allows for a third of one false refutation in 100:
// ln 300 = 5.7, half of the difference of the squares.
TEST_F(RefitsOfABar, ArePairsThatTheHeldOutFramesMayRefute) {
  const BaselineModel model = Model();
  RefittedRanking ranked = RankedWith(model, {Drag(""), Support("")});
  ranked.baseline.errors.has_held_out = true;
  ranked.baseline.unconverged.clear();
  for (size_t k : {0u, 1u}) {
    ranked.effects[k].refitted = true;
    ranked.refits[k] = ranked.baseline;
  }
  FittedPair pair;
  pair.first = "drag";
  pair.second.scored = Support("");
  pair.both = ranked.baseline;
  const double same = pair.both.errors.unfitted_squares;
  pair.both.errors.unfitted_squares = same + 2 * 5;
  EXPECT_FALSE(Predicts(pair.both, ranked.baseline, kWhite));
  EXPECT_TRUE(PairPredicts(pair, ranked, kWhite));
  pair.both.errors.unfitted_squares = same + 2 * 6;
  EXPECT_FALSE(PairPredicts(pair, ranked, kWhite));
  pair.both.errors.unfitted_squares = same;
  EXPECT_TRUE(PairPredicts(pair, ranked, kWhite));

  // One that is refuted beside its second effect alone does not set the noise.
  pair.both.hypothesis.residual *= 0.1;
  pair.both.hypothesis.misfit.residual *= 0.1;
  pair.both.at_fit.misfit.residual *= 0.1;
  ranked.pairs = {pair};
  const RefitContext context{model, ranking_};
  const double with_pair = WeighRefits(context, &ranked).least_rms_over_sigma;
  EXPECT_NEAR(with_pair, 0.1 * RmsOverSigma(ranked.baseline.hypothesis), 1e-9);
  ranked.refits[1].errors.unfitted_squares -= 1e6;
  EXPECT_NEAR(WeighRefits(context, &ranked).least_rms_over_sigma,
              RmsOverSigma(ranked.baseline.hypothesis), 1e-9);
}

// What a nuisance can explain is not underrated because its fit ended early.
TEST_F(RefitsOfABar, WithANuisanceAreNotWorseThanFirstOrderUnlessTheyHaveConverged) {
  RefittedRanking ranked = RankedWith(Model(), {});
  ranked.nuisances[0] = ranked.baseline;  // it explains nothing
  ranked.nuisances[0].unconverged.clear();
  std::vector<ScoredNuisance> nuisances(1);
  nuisances[0].evidence = 7;
  WeighNuisances(ranked, {kWhite, 1}, &nuisances);
  EXPECT_NEAR(nuisances[0].refitted.value(), 0, 1e-9);
  ranked.nuisances[0].unconverged = "the search was ended";
  WeighNuisances(ranked, {kWhite, 1}, &nuisances);
  EXPECT_EQ(nuisances[0].refitted.value(), 7);
  nuisances[0].evidence = -7;
  WeighNuisances(ranked, {kWhite, 1}, &nuisances);
  EXPECT_NEAR(nuisances[0].refitted.value(), 0, 1e-9);
}

// The refits that a pair is compared with have the noise of the columns beside them, which may
// differ from that of the first ranking.
TEST_F(RefitsOfABar, OfPairsHaveTheNoiseOfTheColumnsBesideThem) {
  const BaselineModel model = Model();
  const EffectRefit drag = RefitDrag(model);
  EffectRanking along;
  along.adopted = ranking_.adopted;
  along.misfit = ranking_.misfit;
  along.noise = {0.05, 4};
  along.effects = {Support("")};
  along.nuisances.resize(1);
  along.nuisances[0].uncertain_evidence = 2;  // so that the intervals depend on the noise
  BaselineModel other = model;
  other.noise = {0, 1e-4};
  const auto fit = [&](const BaselineModel& baseline) {
    return FitPair(baseline, Drag(""), drag, "elastic_support", along, /*is_along_first=*/false);
  };
  const std::optional<FittedPair> pair = fit(model), same = fit(other);
  ASSERT_TRUE(pair && same);
  EXPECT_EQ(pair->second.sizes.front().high, same->second.sizes.front().high);
  EXPECT_EQ(pair->both.values_at_fit, same->both.values_at_fit);
}

}  // namespace
}  // namespace lacuna
