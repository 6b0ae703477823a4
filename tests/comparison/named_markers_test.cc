// Comparisons of runs whose experiment and recordings are still there, and of recordings that
// repeat each other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "comparison/planted_run.h"
#include "comparison/run_comparison.h"
#include "report/comparison_report.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::HasSubstr;

TEST(Comparison, MarkersHaveNamesAndDistancesIfTheRecordingIsAvailable) {
  const TemporaryFolder folder;
  const CsvTable misfit = WriteRun(folder / "run", {.error = LowMarker});
  const Comparison without = CompareRun(folder / "run");
  EXPECT_THAT(without.record.notes, testing::ElementsAre(HasSubstr("experiment.yaml")));
  EXPECT_EQ(without.record.recordings[0].point_names[2], "2");
  EXPECT_EQ(without.record.recordings[0].grip_distance.size(), 0);

  WriteExperiment(folder.Path(), misfit);
  const Comparison with = CompareRun(folder / "run");
  EXPECT_THAT(with.record.notes, testing::IsEmpty());
  EXPECT_THAT(with.record.recordings[0].point_names,
              testing::ElementsAre("root", "left", "right", "tip"));
  ASSERT_EQ(with.record.recordings[0].grip_distance.size(), PlantedRun::kMarkers);
  for (int m = 0; m < PlantedRun::kMarkers; ++m)
    EXPECT_NEAR(with.record.recordings[0].grip_distance[m], 0.02 * m, 1e-9);
  EXPECT_EQ(with.record.recordings[0].parts[0].trends.back().quantity, "grip_distance_m");
  EXPECT_THAT(DescribeComparison(with.record)[1],
              HasSubstr("Marker right has the largest rms error"));

  // A recording that has changed since the fit is not used.
  CsvTable changed = misfit;
  changed[5].values.array() += 0.001;
  WriteExperiment(folder.Path(), changed);
  EXPECT_THAT(CompareRun(folder / "run").record.notes,
              testing::ElementsAre(HasSubstr("no longer")));
}

TEST(Comparison, ComparesRepeatsWithEachOther) {
  const TemporaryFolder folder;
  WriteRun(folder / "run", {.recordings = {"a", "b"}});
  const Comparison comparison = CompareRun(folder / "run");
  ASSERT_EQ(comparison.record.recordings.size(), 2u);
  EXPECT_EQ(comparison.record.recordings[1].parts.size(), 1u);  // not fitted at all
  ASSERT_EQ(comparison.record.pairs.size(), 1u);
  EXPECT_NEAR(comparison.record.pairs[0].delay, 0.05, 0.002);
  EXPECT_NEAR(comparison.record.pairs[0].distance, std::sqrt(6.0) * PlantedRun::kNoise,
              0.7 * PlantedRun::kNoise);
}

// Every marker has its own motion, so that only markers of the same name differ by noise.
TEST(Comparison, PairsTheMarkersOfRepeatsByName) {
  const TemporaryFolder folder;
  const CsvTable misfit = WriteRun(folder / "run", {.recordings = {"a", "b"}, .is_mirrored = true});
  WriteExperiment(folder.Path(), misfit, true);
  const ComparisonRecord record = CompareRun(folder / "run").record;
  EXPECT_THAT(record.notes, testing::IsEmpty());
  ASSERT_EQ(record.pairs.size(), 1u);
  EXPECT_NEAR(record.pairs[0].distance, std::sqrt(6.0) * PlantedRun::kNoise,
              0.7 * PlantedRun::kNoise);
  EXPECT_NEAR(record.pairs[0].delay, 0.05, 0.002);
  // Numbers alone do not say which markers are the same.
  std::filesystem::remove(folder / "experiment.yaml");
  EXPECT_THAT(CompareRun(folder / "run").record.pairs, testing::IsEmpty());
}

}  // namespace
}  // namespace lacuna
