// The files that a comparison reads and writes.
#include "comparison/comparison_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "comparison/planted_run.h"
#include "comparison/run_comparison.h"
#include "core/error.h"
#include "record/csv_table.h"
#include "record/run_directory.h"
#include "report/comparison_report.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(Comparison, WritesItsFilesAndLeavesTheRunUnchanged) {
  const TemporaryFolder folder;
  const std::filesystem::path run = folder / "run";
  WriteRun(run, {.error = LowMarker});
  const std::string manifest = FileContent(run / "manifest.json");
  const Comparison comparison = CompareRun(run);
  WriteComparison(comparison, run);
  EXPECT_EQ(FileContent(run / "manifest.json"), manifest);
  const json record = json::parse(FileContent(run / "comparison/comparison.json"));
  const json& held_out = record.at("recordings").at(0).at("parts").at(1);
  EXPECT_EQ(held_out.at("part"), "held out");
  EXPECT_EQ(held_out.at("worst_period").at("first_frame"), 90);
  EXPECT_GT(held_out.at("rms_over_sigma"), 3);
  EXPECT_EQ(record.at("text").size(), 3u);
  const CsvTable by_frame = ReadCsv(run / "comparison/by_frame.csv");
  ASSERT_EQ(by_frame[0].values.size(), PlantedRun::kFrames);
  EXPECT_EQ(by_frame[4].name, "points");
  // Every tenth frame does not show marker 3.
  EXPECT_EQ(by_frame[4].values[0], PlantedRun::kMarkers - 1);
  const CsvTable by_marker = ReadCsv(run / "comparison/by_marker.csv");
  EXPECT_EQ(by_marker[0].values.size(), 2 * PlantedRun::kMarkers);
  EXPECT_THAT(FileContent(run / "comparison/by_quantity.csv"), HasSubstr("\n0,1,speed_m_per_s,"));
  // Its own files do not disturb another comparison.
  EXPECT_EQ(DescribeComparison(CompareRun(run).record), DescribeComparison(comparison.record));
}

TEST(Comparison, AStoredComparisonIsPrintedAsItWasWhenItWasMade) {
  const TemporaryFolder folder;
  const std::filesystem::path run = folder / "run";
  WriteRun(run, {.recordings = {"a", "b"}, .error = LowMarker});
  const Comparison comparison = CompareRun(run);
  const ComparisonRecord& made = comparison.record;
  WriteComparison(comparison, run);
  std::filesystem::remove_all(run / "calibration");
  const ComparisonRecord stored = ReadComparisonFile(run / "comparison/comparison.json");
  EXPECT_EQ(DescribeComparison(stored), DescribeComparison(made));
  EXPECT_EQ(ComparisonTable(stored), ComparisonTable(made));
  EXPECT_EQ(stored.notes, made.notes);
}

TEST(Comparison, AStoredComparisonOfAnotherFormatIsRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "comparison.json";
  const auto why_refused = [&](const std::string& content) -> std::string {
    std::ofstream(file) << content;
    try {
      ReadComparisonFile(file);
    } catch (const InputError& problem) {
      return problem.what();
    }
    return "";
  };
  EXPECT_THAT(why_refused(R"({"schema_version": 1})"), HasSubstr("run `lacuna compare` again"));
  EXPECT_THAT(why_refused("{}"), HasSubstr("is not a comparison"));
  // That of an earlier fit is told apart without being read.
  std::ofstream(file) << R"({"schema_version": 1, "fit": "before"})";
  EXPECT_FALSE(IsComparisonOf("now", file));
  EXPECT_TRUE(IsComparisonOf("before", file));
}

TEST(Comparison, AFitOfAnEarlierVersionIsRefused) {
  const TemporaryFolder folder;
  CsvTable table = WriteRun(folder / "run");
  table.pop_back();  // sigma_m
  RunDirectory directory(folder / "run");
  directory.Begin({{"recordings", json::array()}}, {}, 0);
  directory.Store("calibration", "other", [&](const std::filesystem::path& stage) {
    std::filesystem::copy_file(folder / "run/calibration/calibration.json",
                               stage / "calibration.json");
    WriteCsv(table, stage / "misfit.csv");
  });
  directory.Finish();
  EXPECT_THAT(WhyNotCompared(folder / "run"), HasSubstr("run `lacuna fit` again"));
}

TEST(Comparison, ExplainsWhyAFolderCannotBeCompared) {
  const TemporaryFolder folder;
  EXPECT_THAT(WhyNotCompared(folder / "nowhere"), HasSubstr("no such file or folder"));
  EXPECT_THAT(WhyNotCompared(folder.Path()), HasSubstr("is not a run"));
  const auto store = [&](const std::string& name, const json& configuration,
                         const std::string& stage, bool finish) {
    RunDirectory directory(folder / name);
    directory.Begin(configuration, {}, 0);
    directory.Store(stage, "key", [](const std::filesystem::path& to) {
      std::ofstream(to / "calibration.json") << "{}";
    });
    if (finish) directory.Finish();
    return WhyNotCompared(folder / name);
  };
  EXPECT_THAT(store("followed", {{"recording", "r"}}, "motion", true),
              HasSubstr("a run of `lacuna reconstruct`"));
  EXPECT_THAT(store("stopped", {{"recordings", json::array()}}, "mesh", false),
              HasSubstr("was not finished"));
  EXPECT_THAT(store("odd", {{"recordings", json::array()}}, "calibration", true),
              HasSubstr("is not a record of a calibration"));
  WriteRun(folder / "changed");
  std::ofstream(folder / "changed/calibration/misfit.csv", std::ios::app) << "0,0,0\n";
  EXPECT_THAT(WhyNotCompared(folder / "changed"), HasSubstr("is damaged"));
}

}  // namespace
}  // namespace lacuna
