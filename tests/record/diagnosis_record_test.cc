#include "record/diagnosis_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

DiagnosisRecord SmallDiagnosis() {
  DiagnosisRecord record;
  record.verdict = Verdict::kMissing;
  record.effects = {"drag"};
  record.reasons = {EffectReducesError{"drag", 300, true, false, 5, 1}};
  record.noise = {1e-4, 2e-4, 0.02, 1.5};
  record.baseline_rms_over_sigma = 5;
  record.best_rms_over_sigma = 1;
  record.errors.has_held_out = true;
  record.errors.rms_over_sigma = 4;
  record.nuisances.push_back({"mesh", "a finer mesh", "refine it", 3, 0.1, 2.5, true, 0.5});
  RecordedEffect& effect = record.ranking.emplace_back();
  effect.type = "drag";
  effect.title = "Drag";
  effect.separating_experiment = "film it in vacuum";
  effect.first_order = {310, 0.9, 0.2, 1.1};
  effect.sizes.push_back({"coefficient", "kg/m^3", 1, INFINITY, INFINITY, std::nullopt});
  record.untried.push_back({"plane_contact", "nothing is near"});
  DecisionRecord& decision = record.decision;
  using Kind = HypothesisProbability::Kind;
  decision.probabilities = {{Kind::kEffect, {"drag"}, EffectFamily::kLossOutside, 300, 0.9},
                            {Kind::kNothing, {}, EffectFamily::kOther, 0, 0.1}};
  decision.adequacy = {{"drag"}, 0.2, 0.3, 0.4, 0.25, true, "gravity", 1.5, 1.01, 0.03};
  decision.power = {{{"drag"}, 0.7, 0.1, 0.05, 0.1, 0.05, "mass_damping"}};
  decision.separations = {{"drag", "mass_damping", 6.8}};
  decision.chance = 2.5;
  return record;
}

TEST(DiagnosisRecord, IsReadBackAsItWasWritten) {
  DiagnosisRecord record = SmallDiagnosis();
  RecordedEffect refitted = record.ranking[0];
  refitted.sizes[0].refitted = RecordedInterval{2, 1, INFINITY};
  refitted.refit.emplace().evidence = 300;
  refitted.sizes[0].plausible = 5;
  refitted.sizes[0].at_limit = true;
  refitted.refit->unconverged = "the search was ended";
  refitted.refit->fails_at_limit = true;
  refitted.refit->errors.without_nuisances = 1;
  refitted.refit->others.push_back({"drag.centre_x", "m", {0.05, -INFINITY, 0.07}});
  record.ranking.push_back(refitted);
  record.ranking.back().refit->removed = ByDataKind{700, 0, -3};
  record.alternatives = {{refitted}, 1000, 10};
  record.decision.adequacy.p_unknown_force = NAN;  // no recording shows such a force
  const TemporaryFolder folder;
  WriteDiagnosisFile(record, folder / "diagnosis.json");
  const DiagnosisRecord read = ReadDiagnosisFile(folder / "diagnosis.json");
  EXPECT_EQ(read.verdict, Verdict::kMissing);
  EXPECT_EQ(read.effects, record.effects);
  ASSERT_EQ(read.reasons.size(), 1u);
  EXPECT_EQ(std::get<EffectReducesError>(read.reasons[0]).over_sigma_before, 5);
  EXPECT_EQ(read.noise.correlation_time, 0.02);
  EXPECT_EQ(read.errors.rms_over_sigma, 4);
  EXPECT_EQ(read.nuisances[0].refitted, 2.5);
  EXPECT_EQ(read.untried[0].why, "nothing is near");
  EXPECT_FALSE(read.ranking[0].refit.has_value());
  EXPECT_EQ(read.ranking[0].sizes[0].detectable, INFINITY);
  ASSERT_TRUE(read.ranking[1].HasUsableRefit());
  EXPECT_EQ(read.ranking[1].refit->unconverged, "the search was ended");
  EXPECT_TRUE(read.ranking[1].refit->errors.has_held_out);
  EXPECT_EQ(read.decision.probabilities[1].kind, HypothesisProbability::Kind::kNothing);
  EXPECT_EQ(read.decision.FamilyProbability(EffectFamily::kLossOutside), 0.9);
  EXPECT_TRUE(std::isnan(read.decision.adequacy.p_unknown_force));
  EXPECT_EQ(read.ranking[1].sizes[0].refitted->high, INFINITY);
  EXPECT_TRUE(std::isnan(read.ranking[0].sizes[0].plausible));
  EXPECT_FALSE(read.ranking[0].sizes[0].at_limit);
  EXPECT_EQ(read.ranking[1].sizes[0].plausible, 5);
  EXPECT_TRUE(read.ranking[1].sizes[0].at_limit);
  EXPECT_TRUE(read.ranking[1].refit->fails_at_limit);
  EXPECT_EQ(read.ranking[1].refit->others[0].found.low, -INFINITY);
  ASSERT_TRUE(read.ranking[1].refit->removed);
  EXPECT_EQ(read.ranking[1].refit->removed->markers, 700);
  EXPECT_EQ(read.ranking[1].refit->removed->scans, 0);
  EXPECT_EQ(read.ranking[1].refit->removed->forces, -3);
  ASSERT_EQ(read.alternatives.effects.size(), 1u);
  EXPECT_FALSE(read.alternatives.effects[0].refit->removed);
  EXPECT_EQ(read.alternatives.rms_over_sigma_without_both, 10);
  // Every field is written and read: the second file equals the first.
  WriteDiagnosisFile(read, folder / "again.json");
  EXPECT_EQ(FileContent(folder / "again.json"), FileContent(folder / "diagnosis.json"));
}

// A value of 1 would say that what is left resembles noise, although nobody has looked.
TEST(DiagnosisRecord, ClaimsNothingOfAStatisticOfAdequacyThatThereIsNot) {
  nlohmann::json written = DecisionToJson(DecisionRecord());
  nlohmann::json& adequacy = written.at("adequacy");
  EXPECT_TRUE(adequacy.at("p_unknown_force").is_null());
  EXPECT_TRUE(adequacy.at("p_variance").is_null());
  adequacy.erase("p_unknown_force");
  adequacy.erase("p_variance");
  const DecisionRecord read = DecisionFromJson(written);
  EXPECT_TRUE(std::isnan(read.adequacy.p_unknown_force));
  EXPECT_TRUE(std::isnan(read.adequacy.p_variance));
  // Every decision has one about further effects.
  adequacy.erase("p_further");
  EXPECT_THROW(DecisionFromJson(written), nlohmann::json::exception);
}

TEST(DiagnosisRecord, TellsWhichEffectExplainsMostOfWhatTheCatalogueDoesNotHave) {
  DiagnosisRecord diagnosis;
  diagnosis.verdict = Verdict::kNotInLibrary;
  diagnosis.reasons = {ResidualRemains{"drag", 0.9, 2}};
  HypothesisProbability alone, with_gravity, gravity;
  alone.names = {"drag"};
  alone.probability = 0.6;
  with_gravity.names = {"gravity", "drag"};
  with_gravity.probability = 0.36;
  gravity.names = {"gravity"};
  gravity.probability = 0.04;
  diagnosis.decision.probabilities = {alone, with_gravity, gravity};
  EXPECT_EQ(PartlyExplainedBy(diagnosis), "drag");
  DiagnosisRecord other = diagnosis;
  other.verdict = Verdict::kMissing;  // then it is named
  EXPECT_EQ(PartlyExplainedBy(other), std::nullopt);
  other = diagnosis;
  other.decision.probabilities[1].names = {"gravity"};  // it may as well be gravity
  EXPECT_EQ(PartlyExplainedBy(other), std::nullopt);
  other = diagnosis;
  other.reasons = {ResidualRemains{"drag", 0.4, 2}};  // it explains less than half
  EXPECT_EQ(PartlyExplainedBy(other), std::nullopt);
}

TEST(DiagnosisRecord, AnEarlierFormatIsRefusedWithTheCommandToRun) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { ReadDiagnosisFile(folder / "diagnosis.json"); },
              ThrowsMessage<InputError>(HasSubstr("cannot be read: no such file")));
  std::ofstream(folder / "diagnosis.json") << R"({"schema_version": 8})";
  EXPECT_THAT([&] { ReadDiagnosisFile(folder / "diagnosis.json"); },
              ThrowsMessage<InputError>(HasSubstr("run `lacuna diagnose` again")));
}

}  // namespace
}  // namespace lacuna
