// The document of a report: the models of a run and of the run that it was made from, the results
// of other programs, and folders that it refuses.
#include "report/report_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/small_report.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(ReportDocument, ShowsTheModelsOfTheLedger) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  const json document = ReportDocument({folder / "bar"});
  const json& run = document.at("runs").at(0);
  EXPECT_EQ(run.at("kind"), "prediction");
  EXPECT_EQ(run.at("models").size(), 2u);
  EXPECT_EQ(run.at("models").at(1).at("added"), "drag");
  EXPECT_EQ(run.at("models").at(1).at("label"), "with drag");
  EXPECT_EQ(run.at("models").at(0).at("errors").at("held_out_over_sigma"), 4);
  EXPECT_EQ(run.at("ledger").at("models").size(), 2u);
  EXPECT_EQ(run.at("models").at(0).at("diagnosis").at("verdict"), "missing");
  EXPECT_NEAR(run.at("noise").get<double>(), std::sqrt(3.0) * 1e-4, 1e-12);
  // A run of every kind has all keys.
  for (const char* key : {"reconstruction", "table1", "ablation", "trials", "intervals"}) {
    ASSERT_TRUE(run.contains(key)) << key;
    EXPECT_TRUE(run.at(key).is_null()) << key;
  }
  EXPECT_THAT(run.at("notes"), IsEmpty());
  EXPECT_THAT(document.at("sentences").at(0).get<std::string>(),
              HasSubstr("at marker tip and from 0.31 s to 0.35 s of recording a."));
  const std::vector<std::string> commands = run.at("provenance").at("commands");
  EXPECT_THAT(commands, testing::Contains(HasSubstr("diagnose")));
  EXPECT_EQ(run.at("provenance").at("inputs").at("a/markers.csv"), "1f2e3d");
}

TEST(ReportDocument, AnAddedModelIsShownAfterTheOneThatItWasMadeFrom) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  const json run = ShownRun(folder / "bar+drag");
  EXPECT_EQ(run.at("models").size(), 2u);
  EXPECT_EQ(run.at("models").at(0).at("name"), "bar");
  EXPECT_EQ(run.at("models").at(1).at("added"), "drag");
}

// A run with another recording, such as a planned one, or without the effect of its name is no
// model that `lacuna add` has made.
TEST(ReportDocument, ARunBesideIsShownOnlyIfItsModelLacksTheAddedEffect) {
  const TemporaryFolder folder;
  WriteFit(folder / "bar", {});
  const auto models = [&](const SmallRun& run) {
    WriteFit(folder / run.name, run);
    return ShownRun(folder / run.name).at("models").size();
  };
  EXPECT_EQ(models({.name = "bar+drag", .effects = {"drag"}}), 2u);
  EXPECT_EQ(models({.name = "bar+shake", .effects = {"drag"}}), 1u);
  EXPECT_EQ(models({.name = "bar+swelling", .content = "more", .effects = {"swelling"}}), 1u);
  // Both have it.
  WriteFit(folder / "bar", {.effects = {"drag"}});
  EXPECT_EQ(models({.name = "bar+drag", .effects = {"drag"}}), 1u);
}

TEST(ReportDocument, AModelWhoseAddedEffectMayBeZeroDoesNotCount) {
  const TemporaryFolder folder;
  Ledger ledger = SmallLedger();
  DiagnosisRecord diagnosis = *ledger.models[0].diagnosis;
  diagnosis.ranking[0].title = "Drag (of air)";
  diagnosis.ranking[0].sizes = {{"coefficient", "kg/m^3"}};
  WriteSmallFit(folder / "bar", {}, ledger.models[0].record);
  WriteSmallDiagnosis(folder / "bar", diagnosis);
  CalibrationRecord record = ledger.models[1].record;
  ParameterEstimate& estimate = record.parameters[1].estimate;
  const auto second = [&](double low) {
    estimate.low = low;
    estimate.high = 5;
    WriteSmallFit(folder / "bar+drag", {.name = "bar+drag", .effects = {"drag"}}, record);
    return ShownRun(folder / "bar+drag").at("models").at(1);
  };
  EXPECT_EQ(second(1).at("label"), "with drag");
  EXPECT_EQ(second(1).at("counts"), true);
  EXPECT_EQ(second(-1).at("counts"), false);
}

TEST(ReportDocument, CorrelationsOfAllPairsOfPointsAreLeftOut) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  const json comparison = ShownRun(folder / "bar").at("models").at(0).at("comparison");
  const json& space = comparison.at("recordings").at(0).at("parts").at(0).at("space_correlation");
  EXPECT_TRUE(space.contains("mean_correlation"));
  EXPECT_FALSE(space.contains("pairs"));
}

TEST(ReportDocument, SealedCasesHaveOneSentenceForEachKindOfTruth) {
  const TemporaryFolder folder;
  const auto rate = [](const char* truth, const char* what, int cases, int of) {
    return json{{"truth", truth}, {"what", what}, {"cases", cases}, {"of", of}, {"predicted", {}}};
  };
  json report = {{"tallies", json::array()},
                 {"rates",
                  {rate("nothing is missing", "an effect is named", 0, 17),
                   rate("nothing is missing", "several are named", 0, 17),
                   rate("two effects are missing", "both are named", 0, 0),
                   rate("one effect is missing", "it is named, and no other", 11, 18)}}};
  std::ofstream(folder / "report.json") << report;
  EXPECT_THAT(ReportDocument({folder.Path()}).at("sentences"),
              ElementsAre("In 0 of 17 cases in which nothing is missing, an effect is named.",
                          "In 11 of 18 cases in which one effect is missing, it is named, and no "
                          "other."));
  report["rates"][0].erase("of");
  std::ofstream(folder / "report.json") << report;
  EXPECT_THAT(WhyRefused({folder.Path()}), HasSubstr("report.json"));
}

TEST(ReportDocument, IntervalsAreShownWithHowOftenTheyHold) {
  const TemporaryFolder folder;
  json report = {{"schema_version", 1},
                 {"parameters",
                  {{{"name", "young_modulus"},
                    {"draws", 101},
                    {"covered_50", 0.5},
                    {"covered_80", 0.76},
                    {"covered_95", 0.92},
                    {"mean", -0.23},
                    {"spread", 1.04},
                    {"p_uniform", 0.28},
                    {"positions", {0.1, 0.5, 0.9}}}}}};
  std::ofstream(folder / "intervals.json") << report;
  const json document = ReportDocument({folder.Path()});
  EXPECT_THAT(document.at("sentences"),
              ElementsAre("The 95 % interval of young_modulus contains the truth in 92 % of 101 "
                          "draws."));
  EXPECT_EQ(document.at("runs").at(0).at("kind"), "intervals");
  EXPECT_EQ(document.at("runs").at(0).at("intervals"), report);
  report["parameters"][0].erase("covered_95");
  std::ofstream(folder / "intervals.json") << report;
  EXPECT_THAT(WhyRefused({folder.Path()}), HasSubstr("intervals.json"));
}

TEST(ReportDocument, RefusesWhatIsNoRun) {
  const TemporaryFolder folder;
  EXPECT_THAT(WhyRefused({folder / "absent"}), HasSubstr("there is no such folder"));
  EXPECT_THAT(WhyRefused({folder.Path()}), HasSubstr("is not a run"));
  WriteFit(folder / "a", {});
  std::ofstream(folder / "a/calibration/calibration.json", std::ios::app) << "\n";
  EXPECT_THAT(WhyRefused({folder / "a"}), HasSubstr("calibration.json"));
}

TEST(ReportDocument, WithoutPackedArraysIsSmallAndHasTheNumbers) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  const json document = WithoutPackedArrays(ReportDocument({folder / "bar"}));
  EXPECT_THAT(document.dump(), testing::Not(HasSubstr("base64")));
  const json& scene = document.at("runs").at(0).at("models").at(0).at("scenes").at(0);
  EXPECT_EQ(scene.at("series").at("rms_m").size(), 40u);
  EXPECT_FALSE(scene.at("points").contains("measured"));
}

}  // namespace
}  // namespace lacuna
