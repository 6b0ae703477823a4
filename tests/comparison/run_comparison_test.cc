// What a comparison finds in errors that are known: noise, and a place, a time, a quantity and a
// part that does not change.
#include "comparison/run_comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "comparison/comparison_files.h"
#include "comparison/planted_run.h"
#include "record/csv_table.h"
#include "report/comparison_report.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Comparison, AnErrorThatIsOnlyNoiseIsReportedAsNoise) {
  const TemporaryFolder folder;
  WriteRun(folder / "run");
  const Comparison comparison = CompareRun(folder / "run");
  ASSERT_EQ(comparison.record.recordings.size(), 1u);
  const ComparedRecording& recording = comparison.record.recordings[0];
  ASSERT_EQ(recording.parts.size(), 2u);
  EXPECT_TRUE(recording.parts[0].fitted);
  EXPECT_FALSE(recording.parts[1].fitted);
  EXPECT_EQ(recording.parts[0].error.points,
            PlantedRun::kFittedFrames * PlantedRun::kMarkers - PlantedRun::kFittedFrames / 10);
  // 900 coordinates: 2.4 %.
  for (const ComparedPart& part : recording.parts) EXPECT_NEAR(part.error.rms_over_sigma, 1, 0.1);
  EXPECT_FALSE(recording.parts[0].worst_period);
  // Medians of 120 second differences over 12 rows.
  EXPECT_NEAR(recording.noise_floor.white, PlantedRun::kNoise, 0.25 * PlantedRun::kNoise);
  ASSERT_GE(recording.noise_floor.rests.size(), 1u);
  EXPECT_NEAR(recording.noise_floor.rest_deviation, PlantedRun::kNoise, 0.2 * PlantedRun::kNoise);
  for (const ComparedPart& part : recording.parts) EXPECT_NEAR(part.error.rms_over_floor, 1, 0.25);
  const std::vector<std::string> words = DescribeComparison(comparison.record);
  EXPECT_THAT(words[0], HasSubstr("a, fitted frames, 0.000 s to 0.790 s"));
  EXPECT_THAT(words[0], HasSubstr("Nothing here contradicts the model."));
}

// Two of four markers have five times the noise. Over the noise of a typical marker, the rms error
// would be √((1 + 25)/2) = 3.6.
TEST(Comparison, EachMarkerCountsInUnitsOfItsOwnNoise) {
  const TemporaryFolder folder;
  const std::filesystem::path run = folder / "run";
  WriteRun(run,
           {.noise = [](int marker) { return (marker % 2 == 0 ? 1 : 5) * PlantedRun::kNoise; }});
  const Comparison comparison = CompareRun(run);
  const ComparedRecording& recording = comparison.record.recordings[0];
  ASSERT_EQ(recording.parts.size(), 2u);
  for (const ComparedPart& part : recording.parts) {
    EXPECT_NEAR(part.error.rms_over_sigma, 1, 0.1);
    EXPECT_NEAR(part.error.rms_over_floor, 1, 0.25);
    EXPECT_FALSE(part.worst_period);
    EXPECT_FALSE(part.trends.empty());
    for (const ErrorTrend& trend : part.trends)
      for (const ErrorBin& bin : trend.bins)
        EXPECT_NEAR(bin.rms_over_sigma, 1, 0.4) << trend.quantity;  // at least 40 coordinates
  }
  EXPECT_NEAR(recording.noise_floor.floor, PlantedRun::kNoise, 0.3 * PlantedRun::kNoise);
  WriteComparison(comparison, run);
  const CsvTable by_marker = ReadCsv(run / "comparison/by_marker.csv");
  ASSERT_EQ(by_marker[5].name, "rms_over_sigma");
  ASSERT_EQ(by_marker[5].values.size(), 2 * PlantedRun::kMarkers);
  for (const double multiple : by_marker[5].values) EXPECT_NEAR(multiple, 1, 0.25);
}

TEST(Comparison, FindsWhereAndWhenAnErrorOccurs) {
  const TemporaryFolder folder;
  WriteRun(folder / "run", {.error = LowMarker});
  const Comparison comparison = CompareRun(folder / "run");
  const ComparedPart& held_out = comparison.record.recordings[0].parts[1];
  EXPECT_NEAR(comparison.record.recordings[0].parts[0].error.rms_over_sigma, 1, 0.1);
  EXPECT_EQ(held_out.worst_point, 2);
  EXPECT_EQ(held_out.error.largest_point, 2);
  ASSERT_TRUE(held_out.worst_period);
  EXPECT_EQ(held_out.worst_period->first_frame, 90);
  EXPECT_EQ(held_out.worst_period->last_frame, 109);
  EXPECT_LT(held_out.in_time.p_value, 0.01);
  // A millimetre in 20 of the 156 observations of markers: √0.128 mm.
  EXPECT_NEAR(held_out.error.rms, 1e-3 * std::sqrt(0.128), 0.03e-3);
  const std::string words = DescribeComparison(comparison.record)[1];
  EXPECT_THAT(words, HasSubstr("a, held-out frames"));
  EXPECT_THAT(words, HasSubstr("The error is not noise"));
  EXPECT_THAT(words, HasSubstr("Marker 2 has the largest rms error"));
  EXPECT_THAT(words, HasSubstr("0.900 s to 1.090 s"));
  EXPECT_THAT(words, HasSubstr("toward −z"));
}

TEST(Comparison, ReportsAnErrorThatGrowsWithSpeed) {
  const TemporaryFolder folder;
  WriteRun(folder / "run", {.error = [](int frame, int) {
             const double moving = std::max(0.0, 0.01 * frame - 0.3);
             return Eigen::Vector3d(0, 0, moving > 0 ? 1e-3 * std::cos(8 * moving) : 0);
           }});
  const ComparedPart fitted = CompareRun(folder / "run").record.recordings[0].parts[0];
  const ErrorTrend& speed = fitted.trends[2];
  ASSERT_EQ(speed.quantity, "speed_m_per_s");
  EXPECT_GT(speed.rank_correlation, 0.8);
  for (const ErrorTrend& other : fitted.trends)
    EXPECT_LE(other.rank_correlation, speed.rank_correlation) << other.quantity;
  EXPECT_THAT(DescribeComparison(CompareRun(folder / "run").record)[0],
              HasSubstr("The error grows with speed"));
}

// Every second marker is displaced by 1 mm: √(1/2) mm rms, apart from noise and from the frames in
// which the last marker was not observed.
TEST(Comparison, DistinguishesASteadyErrorFromOneThatChanges) {
  const TemporaryFolder folder;
  WriteRun(folder / "run", {.error = [](int frame, int marker) {
             return Eigen::Vector3d(0, marker % 2 == 0 ? 1e-3 : 0, 4e-4 * std::sin(frame));
           }});
  const Comparison comparison = CompareRun(folder / "run");
  const ComparedPart& fitted = comparison.record.recordings[0].parts[0];
  EXPECT_NEAR(fitted.error.steady, std::sqrt(0.5) * 1e-3, 2e-5);
  EXPECT_NEAR(fitted.error.changing, std::sqrt(0.5) * 4e-4, 2e-5);
  EXPECT_THAT(DescribeComparison(comparison.record)[0], HasSubstr("is the same in all frames"));
  WriteRun(folder / "noise");
  EXPECT_THAT(DescribeComparison(CompareRun(folder / "noise").record)[0],
              Not(HasSubstr("the same in all")));
}

}  // namespace
}  // namespace lacuna
