// Records of an earlier fit, diagnosis or version are left out of a report's document, with a note.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/hash.h"
#include "core/json_file.h"
#include "record/manifest.h"
#include "record/plan_record.h"
#include "report/small_report.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(ReportDocument, APlanIsShownAsLongAsItsDiagnosisStands) {
  const TemporaryFolder folder;
  const Ledger ledger = SmallLedger();
  const std::filesystem::path run = folder / "bar";
  WriteFit(run, {});
  WriteSmallDiagnosis(run, *ledger.models[0].diagnosis);
  std::filesystem::create_directories(run / "plan");
  PlanRecord plan;
  plan.run = "bar";
  plan.diagnosis = HashFile(run / "diagnosis/diagnosis.json");
  WritePlanFile(plan, run / "plan/plan.json");
  json document = ShownRun(run);
  EXPECT_EQ(document.at("models").at(0).at("plan").at("run"), "bar");
  EXPECT_THAT(document.at("notes"), IsEmpty());
  DiagnosisRecord other = *ledger.models[0].diagnosis;
  other.time_step = 0.001;
  WriteSmallDiagnosis(run, other);
  document = ShownRun(run);
  EXPECT_TRUE(document.at("models").at(0).at("plan").is_null());
  EXPECT_THAT(document.at("notes").at(0).get<std::string>(),
              HasSubstr("is of an earlier diagnosis and is not shown; `lacuna plan` makes"));
}

TEST(ReportDocument, APlanOfAnotherFormatIsLeftOutWithANote) {
  const TemporaryFolder folder;
  const std::filesystem::path run = folder / "bar";
  WriteFit(run, {});
  WriteSmallDiagnosis(run, *SmallLedger().models[0].diagnosis);
  std::filesystem::create_directories(run / "plan");
  json plan = {{"schema_version", 3},
               {"diagnosis", HashFile(run / "diagnosis/diagnosis.json")},
               {"rivals", json::array()},
               {"outcomes", json::array()}};
  const auto expect_note = [&](const std::string& origin) {
    std::ofstream(run / "plan/plan.json") << plan;
    const json document = ShownRun(run);
    EXPECT_TRUE(document.at("models").at(0).at("plan").is_null());
    const std::vector<std::string> notes = document.at("notes");
    EXPECT_THAT(notes, ElementsAre(HasSubstr("The plan in the folder of bar is of " + origin +
                                             " and is not shown; `lacuna plan` makes")));
  };
  expect_note("an earlier version of Lacuna");
  plan["schema_version"] = 99;
  expect_note("a later version of Lacuna");
}

TEST(ReportDocument, WhatIsOfAnEarlierFitIsLeftOutWithANote) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  std::filesystem::remove(folder / "bar/ledger.json");
  CalibrationRecord other = SmallLedger().models[0].record;
  other.rms = 7;
  WriteSmallFit(folder / "other", {}, other);
  std::filesystem::copy(folder / "bar/comparison", folder / "other/comparison");
  std::filesystem::copy(folder / "bar/diagnosis", folder / "other/diagnosis");
  std::filesystem::copy(
      folder / "bar/shown_motion", folder / "other/shown_motion",
      std::filesystem::copy_options::recursive | std::filesystem::copy_options::overwrite_existing);
  const json run = ShownRun(folder / "other");
  const json& model = run.at("models").at(0);
  EXPECT_TRUE(model.at("comparison").is_null());
  EXPECT_TRUE(model.at("diagnosis").is_null());
  EXPECT_TRUE(model.at("scenes").at(0).at("surface").is_null());
  const std::vector<std::string> notes = run.at("notes");
  EXPECT_THAT(notes, ElementsAre(HasSubstr("comparison"), HasSubstr("diagnosis")));
}

TEST(ReportDocument, ALedgerOfOtherFitsIsLeftOut) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  CalibrationRecord changed = SmallLedger().models[0].record;
  changed.recordings[0].held_out.rms = 9e-4;
  WriteSmallFit(folder / "bar", {}, changed);
  const json run = ShownRun(folder / "bar");
  EXPECT_TRUE(run.at("ledger").is_null());
  EXPECT_EQ(run.at("models").size(), 1u);
  EXPECT_THAT(run.at("notes").at(0).get<std::string>(), HasSubstr("ledger"));
}

TEST(ReportDocument, AnAddedModelOfAnotherVersionIsLeftOut) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  const std::filesystem::path file = folder / "bar+drag/calibration/calibration.json";
  json calibration = ReadJsonFile(file);
  calibration["schema_version"] = 1;
  std::ofstream(file) << calibration;
  const std::filesystem::path manifest_file = folder / "bar+drag/manifest.json";
  Manifest manifest = ReadManifest(manifest_file);
  for (StoredFile& stored : manifest.stages.at("calibration").files) {
    if (stored.name != "calibration.json") continue;
    stored.size = std::filesystem::file_size(file);
    stored.hash = HashFile(file);
  }
  WriteManifest(manifest, manifest_file);
  const json run = ShownRun(folder / "bar");
  EXPECT_EQ(run.at("models").size(), 1u);
  EXPECT_THAT(run.at("notes").at(0).get<std::string>(), HasSubstr("ledger"));
}

}  // namespace
}  // namespace lacuna
