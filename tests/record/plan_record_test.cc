// The file of a plan: what it says about its rivals, and which plans are outdated.
#include "record/plan_record.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using nlohmann::json;

constexpr double kNotComputed = std::numeric_limits<double>::quiet_NaN();

json Written(const PlanRecord& plan) {
  const TemporaryFolder folder;
  WritePlanFile(plan, folder / "plan.json");
  std::ifstream stream(folder / "plan.json");
  return json::parse(stream);
}

PlanRecord PlanOfTwoRivals() {
  PlanRecord plan;
  plan.diagnosis = "ab12";
  plan.rivals = {
      {"drag with gravity", "drag together with gravity", 0.7, 0, {"drag", "gravity"}, 0.35},
      {"mass_damping", "mass-proportional damping", 0.3, 0.2, {"mass_damping"}, 0.15}};
  return plan;
}

// A reader need not take the name of a pair apart.
TEST(PlanFile, ListsTheEffectsOfEachRival) {
  const json plan = Written(PlanOfTwoRivals());
  EXPECT_EQ(plan.at("schema_version"), 4);
  const json expected = json::parse(R"([
    {"effect": "drag with gravity", "effects": ["drag", "gravity"],
     "title": "drag together with gravity", "probability": 0.7, "of_diagnosis": 0.35,
     "named_now": 0.0},
    {"effect": "mass_damping", "effects": ["mass_damping"],
     "title": "mass-proportional damping", "probability": 0.3, "of_diagnosis": 0.15,
     "named_now": 0.2}])");
  EXPECT_EQ(plan.at("rivals"), expected);
}

TEST(PlanFile, HasTheProbabilitiesOfTheRivalsByTheirNames) {
  PlanRecord plan = PlanOfTwoRivals();
  PlannedOutcome& outcome = plan.outcomes.emplace_back();
  outcome.named = {0.9, 0.8};
  outcome.sizes = {{"drag with gravity", "drag.coefficient", "kg/m", 0.4, kNotComputed, 0.1}};
  const json written = Written(plan).at("outcomes").at(0);
  EXPECT_EQ(written.at("named"), json::parse(R"({"drag with gravity": 0.9, "mass_damping": 0.8})"));
  EXPECT_TRUE(written.at("sizes").at(0).at("half_width_now").is_null()) << "JSON has no NaN";
  EXPECT_EQ(written.at("sizes").at(0).at("half_width_then"), 0.1);
}

TEST(PlanFile, SaysWhatItDoesNotWeigh) {
  PlanRecord plan = PlanOfTwoRivals();
  plan.no_effect = 0.5;
  plan.also_left = {{"clock", "the clock of the frames", 0.4}};
  plan.outcomes.emplace_back().untried = {{"mesh", "no other mesh could be made"}};
  const json written = Written(plan);
  EXPECT_EQ(written.at("outcomes").at(0).at("untried"),
            json::parse(R"([{"nuisance": "mesh", "why": "no other mesh could be made"}])"));
  EXPECT_EQ(written.at("no_effect"), 0.5);
  EXPECT_EQ(
      written.at("also_left"),
      json::parse(
          R"([{"nuisance": "clock", "title": "the clock of the frames", "probability": 0.4}])"));
}

TEST(PlanFile, BelongsToItsDiagnosisAndToThisFormat) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "plan.json";
  WritePlanFile(PlanOfTwoRivals(), file);
  EXPECT_TRUE(IsPlanOf("ab12", file));
  EXPECT_FALSE(IsPlanOf("cd34", file));
  EXPECT_EQ(VersionOfPlan(file), RecordVersion::kThis);
  std::ofstream(file) << R"({"schema_version": 3, "diagnosis": "ab12"})";
  EXPECT_TRUE(IsPlanOf("ab12", file));
  EXPECT_EQ(VersionOfPlan(file), RecordVersion::kEarlier);
  std::ofstream(file) << R"({"diagnosis": "ab12"})";
  EXPECT_EQ(VersionOfPlan(file), RecordVersion::kEarlier);
  std::ofstream(file) << R"({"schema_version": 99, "diagnosis": "ab12"})";
  EXPECT_EQ(VersionOfPlan(file), RecordVersion::kLater);
}

TEST(PlannedRival, IsAPairIfItHasTwoEffects) {
  const PlanRecord plan = PlanOfTwoRivals();
  EXPECT_TRUE(plan.rivals[0].IsPair());
  EXPECT_FALSE(plan.rivals[1].IsPair());
}

}  // namespace
}  // namespace lacuna
