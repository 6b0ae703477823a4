#include "diagnosis/diagnosis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "diagnosis/decision.h"
#include "diagnosis/diagnosed_bar.h"
#include "diagnosis/recorded_diagnosis.h"
#include "diagnosis/thresholds.h"
#include "diagnosis/verdict.h"
#include "effects/catalogue.h"
#include "effects/gravity.h"
#include "report/verdict_text.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::Contains;

// The truth has a finer mesh and shorter steps; the error of the model is about 1.5 to 2 σ.
constexpr double kModelError = 2;  // σ

const std::map<std::string, std::string> kWithoutDamping{
    {"  - {type: mass_damping, alpha: 1 1/s}\n", ""}, {", {name: mass_damping.alpha}", ""}};

TEST(Diagnosis, NamesADampingThatTheModelLacks) {
  HeldBarTruth truth;
  truth.alpha = 12;
  const Diagnosis diagnosis = DiagnoseBar(truth, kWithoutDamping);
  EXPECT_GT(diagnosis.errors.rms_over_sigma, 3 * kModelError);
  ASSERT_TRUE(diagnosis.verdict == Verdict::kMissing || diagnosis.verdict == Verdict::kAmbiguous)
      << ExplainVerdict(RecordOf(diagnosis));
  EXPECT_THAT(diagnosis.effects, Contains("mass_damping"));
  for (const RankedEffect& effect : diagnosis.ranking) {
    if (effect.scored.candidate.type != "mass_damping") continue;
    EXPECT_TRUE(effect.refitted);
    EXPECT_LT(effect.errors.rms_over_sigma, kModelError);
    // 1/s; the width of the interval is a tenth of the value.
    ASSERT_EQ(effect.sizes.size(), 1u);
    EXPECT_NEAR(effect.sizes[0].value, truth.alpha, 0.15 * truth.alpha);
    EXPECT_LT(effect.sizes[0].low, effect.sizes[0].value);
    EXPECT_GT(effect.sizes[0].high, effect.sizes[0].value);
    EXPECT_TRUE(effect.others.empty());
  }
}

TEST(Diagnosis, NamesNoEffectIfNothingIsMissing) {
  const Diagnosis diagnosis = DiagnoseBar({}, {});
  EXPECT_NE(diagnosis.verdict, Verdict::kMissing) << ExplainVerdict(RecordOf(diagnosis));
  EXPECT_NE(diagnosis.verdict, Verdict::kAmbiguous) << ExplainVerdict(RecordOf(diagnosis));
}

// Six tetrahedra miss the truth by far more than the damping does.
TEST(Diagnosis, DoesNotTakeTheErrorOfAVeryCoarseMeshForAnEffect) {
  HeldBarTruth truth;
  truth.alpha = 6;
  truth.noise = 4e-4;
  std::map<std::string, std::string> replaced = kWithoutDamping;
  replaced["noise: 0.05 mm"] = "noise: 0.4 mm";
  const Diagnosis diagnosis = DiagnoseBar(truth, replaced, {}, {1, 1, 1});
  ASSERT_EQ(diagnosis.verdict, Verdict::kAmbiguous) << ExplainVerdict(RecordOf(diagnosis));
  EXPECT_THAT(diagnosis.effects, Contains("mass_damping"));
  const auto mesh = std::find_if(
      diagnosis.nuisances.begin(), diagnosis.nuisances.end(),
      [](const ScoredNuisance& nuisance) { return nuisance.candidate.card.name == "mesh"; });
  ASSERT_NE(mesh, diagnosis.nuisances.end());
  EXPECT_GT(mesh->candidate.columns.cwiseAbs().maxCoeff(), truth.noise);
}

TEST(Diagnosis, FitsTheMostProbablePairOfEffectsAndItsRivals) {
  HeldBarTruth truth;
  truth.alpha = 8;
  const Eigen::Vector3d steady(0, 0.05, 0.1);  // N, of a bar of 32 g
  truth.body_force = [&](double) { return steady; };
  const Diagnosis diagnosis = DiagnoseBar(truth, kWithoutDamping);
  // The most probable pair, and its rivals.
  ASSERT_GE(diagnosis.decision_input.pairs.size(), 2u) << ExplainVerdict(RecordOf(diagnosis));
  const WeighedPair& pair = diagnosis.decision_input.pairs.front();
  EXPECT_EQ(pair.first, "mass_damping");
  // A force on a part of the bar is much like one on all of it.
  EXPECT_EQ(FamilyOf(diagnosis.decision_input.families, pair.second), GravityCard().family);
  EXPECT_TRUE(pair.predicts);
  EXPECT_GT(pair.gain, 20);
  const HypothesisProbability& best = diagnosis.decision.probabilities.front();
  EXPECT_EQ(best.kind, HypothesisProbability::Kind::kPair);
  // The rivals are of the same two families, and each is weighed.
  const auto family = [&](const std::string& effect) {
    return FamilyOf(diagnosis.decision_input.families, effect);
  };
  for (const WeighedPair& rival : diagnosis.decision_input.pairs) {
    EXPECT_THAT((std::set{family(rival.first), family(rival.second)}),
                ::testing::Eq(std::set{family(pair.first), family(pair.second)}))
        << rival.first << ", " << rival.second;
    EXPECT_TRUE(std::any_of(
        diagnosis.decision.probabilities.begin(), diagnosis.decision.probabilities.end(),
        [&](const HypothesisProbability& one) {
          return one.names.size() == 2 && one.Contains(rival.first) && one.Contains(rival.second);
        }));
  }
}

// Without a time step in the experiment, the first fit starts with half of the frame spacing. A
// much stronger damping would leave the step as it is: what is unknown about its error would be
// less than a hundredth of the evidence.
TEST(Diagnosis, ShortensATimeStepWhoseErrorCouldLookLikeAnEffect) {
  HeldBarTruth truth;
  truth.alpha = 1;
  std::map<std::string, std::string> left_open = kWithoutDamping;
  left_open["motion: {time_step: 1.5 ms}\n"] = "";
  const Diagnosis shortened = DiagnoseBar(truth, left_open, {.refits = 1, .without = {}});
  EXPECT_LT(shortened.time_step, 0.003);
  std::map<std::string, std::string> given = kWithoutDamping;
  given["time_step: 1.5 ms"] = "time_step: 5 ms";
  const Diagnosis as_given = DiagnoseBar(truth, given, {.refits = 1, .without = {}});
  EXPECT_DOUBLE_EQ(as_given.time_step, 0.005);
  const auto uncertain_evidence = [](const Diagnosis& diagnosis) {
    for (const ScoredNuisance& nuisance : diagnosis.nuisances)
      if (nuisance.candidate.card.shrinks_with_time_step) return nuisance.uncertain_evidence;
    return std::nan("");
  };
  EXPECT_GT(uncertain_evidence(as_given), kThresholds.refit.uncertain_step_evidence);
  EXPECT_LT(uncertain_evidence(shortened), 0.5 * uncertain_evidence(as_given));
}

TEST(Diagnosis, NamesTheTimeErrorsOfSingleFrames) {
  HeldBarTruth truth;
  truth.jitter = 1e-3;
  const Diagnosis diagnosis = DiagnoseBar(truth, {});
  EXPECT_EQ(diagnosis.verdict, Verdict::kNuisance) << ExplainVerdict(RecordOf(diagnosis));
  EXPECT_THAT(diagnosis.effects, Contains("time_jitter"));
  EXPECT_GT(diagnosis.alternatives.nuisances_evidence, 50);
  // The time error of a frame says nothing about another frame, so held-out frames are missed alike
  // with the nuisance and without it.
  EXPECT_GT(diagnosis.errors.without_nuisances, 1.1);
  EXPECT_NEAR(diagnosis.alternatives.bare.without_nuisances / diagnosis.errors.without_nuisances, 1,
              0.1);
}

TEST(Diagnosis, HasNoPowerIfNoEffectIsDetectable) {
  // 100 m of noise on a bar of 0.08 m.
  const Diagnosis diagnosis = DiagnoseBar({}, {{"noise: 0.05 mm", "noise: 100 m"}});
  EXPECT_EQ(diagnosis.verdict, Verdict::kNoPower) << ExplainVerdict(RecordOf(diagnosis));
}

// The members of a pair are named together, and may explain nothing one by one.
TEST(Diagnosis, AnEffectWithoutEvidenceExplainsNoPartOfWhatIsUnknown) {
  Diagnosis diagnosis;
  diagnosis.errors.rms_over_sigma = 20;
  diagnosis.baseline_rms_over_sigma = 10;
  for (const auto& [type, evidence] : {std::pair("drag", -600.0), std::pair("gravity", 7.0)}) {
    RankedEffect& effect = diagnosis.ranking.emplace_back();
    effect.scored.candidate.type = type;
    effect.refitted = true;
    effect.evidence = evidence;
    effect.rms_over_sigma = 9;
  }
  Decision decision;
  decision.verdict = Verdict::kNotInLibrary;
  decision.names = {"drag", "gravity"};
  Conclude(decision, &diagnosis);
  ASSERT_EQ(diagnosis.reasons.size(), 1u);
  const auto* unexplained = std::get_if<ErrorUnexplained>(&diagnosis.reasons[0]);
  ASSERT_NE(unexplained, nullptr);
  EXPECT_EQ(unexplained->best_evidence, 7);
  EXPECT_EQ(unexplained->rms_over_sigma, 20);

  diagnosis.ranking[0].evidence = 600;
  Conclude(decision, &diagnosis);
  ASSERT_EQ(diagnosis.reasons.size(), 1u);
  const auto* remains = std::get_if<ResidualRemains>(&diagnosis.reasons[0]);
  ASSERT_NE(remains, nullptr);
  EXPECT_EQ(remains->effect, "drag");
}

// What is left is that of the hypothesis that was tested, which may have a nuisance, too.
TEST(Diagnosis, StatesWhatIsLeftBesideAnEffectAndANuisance) {
  Diagnosis diagnosis;
  diagnosis.baseline_rms_over_sigma = 10;
  RankedEffect& effect = diagnosis.ranking.emplace_back();
  effect.scored.candidate.type = "drag";
  effect.refitted = true;
  effect.evidence = 600;
  effect.rms_over_sigma = 3;
  Decision decision;
  decision.verdict = Verdict::kNotInLibrary;
  decision.names = {"drag"};
  decision.record.adequacy.beside = {"drag", "clock"};
  decision.record.adequacy.rms_over_sigma = 1.5;
  const auto left = [&] {
    Conclude(decision, &diagnosis);
    const auto* remains = std::get_if<ResidualRemains>(&diagnosis.reasons.at(0));
    return remains != nullptr ? remains->rms_over_sigma : 0;
  };
  EXPECT_EQ(left(), 1.5);
  // The hypothesis that was tested does not contain the effect.
  decision.record.adequacy.beside = {"clock"};
  EXPECT_EQ(left(), 3);
}

TEST(Diagnosis, IsRecordedWithTheVerdictAndEveryEffect) {
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::kNotInLibrary;
  diagnosis.ranking.emplace_back();
  ScoredEffect& scored = diagnosis.ranking.back().scored;
  scored.candidate.type = "drag";
  scored.parameters = {"coefficient"};
  scored.units = {"kg/m^3"};
  scored.score.size = scored.score.deviation = Eigen::VectorXd::Ones(1);
  scored.score.detectable = Eigen::VectorXd::Constant(1, INFINITY);
  diagnosis.ranking.push_back(diagnosis.ranking.back());
  RankedEffect& refitted = diagnosis.ranking.back();
  refitted.refitted = true;
  refitted.sizes.resize(1);
  refitted.sizes[0].value = 2;
  refitted.sizes[0].low = 1;
  ParameterEstimate place;
  place.value = 0.05;
  place.high = 0.07;
  refitted.others = {{"drag.centre_x", "m", place}};
  refitted.removed = ByDataKind{0, 20, 10};
  const TemporaryFolder folder;
  WriteDiagnosisFile(RecordOf(diagnosis), folder / "diagnosis.json");
  std::ifstream stream(folder / "diagnosis.json");
  const auto written = nlohmann::json::parse(stream);
  EXPECT_EQ(written["verdict"], "not in library");
  EXPECT_EQ(written["ranking"][0]["effect"], "drag");
  EXPECT_TRUE(written["ranking"][0]["sizes"][0]["detectable"].is_null());
  const DiagnosisRecord read = ReadDiagnosisFile(folder / "diagnosis.json");
  EXPECT_EQ(read.verdict, Verdict::kNotInLibrary);
  EXPECT_EQ(read.ranking[0].title, FindEntry("drag")->card->title);
  EXPECT_EQ(read.ranking[0].sizes[0].expected, 1);
  EXPECT_FALSE(read.ranking[0].sizes[0].refitted.has_value());
  ASSERT_TRUE(read.ranking[1].sizes[0].refitted.has_value());
  EXPECT_EQ(read.ranking[1].sizes[0].refitted->value, 2);
  EXPECT_EQ(read.ranking[1].sizes[0].refitted->low, 1);
  EXPECT_EQ(read.ranking[1].sizes[0].refitted->high, INFINITY);
  EXPECT_FALSE(read.ranking[0].refit.has_value());
  ASSERT_TRUE(read.ranking[1].refit.has_value());
  ASSERT_TRUE(read.ranking[1].refit->removed.has_value());
  EXPECT_EQ(read.ranking[1].refit->removed->scans, 20);
  const std::vector<RecordedValue>& others = read.ranking[1].refit->others;
  ASSERT_EQ(others.size(), 1u);
  EXPECT_EQ(others[0].parameter, "drag.centre_x");
  EXPECT_EQ(others[0].unit, "m");
  EXPECT_EQ(others[0].found.value, 0.05);
  EXPECT_EQ(others[0].found.low, -INFINITY);
  EXPECT_EQ(others[0].found.high, 0.07);
}

}  // namespace
}  // namespace lacuna
