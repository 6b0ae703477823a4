#include "report/comparison_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "report/quantity_text.h"

namespace lacuna {
namespace {

using testing::HasSubstr;
using testing::Not;

// A recording with one held-out part, whose error is correlated in time.
ComparisonRecord Example() {
  ComparedPart part;
  part.fitted = false;
  part.frames = 100;
  part.to = 1;
  part.error.points = 400;
  part.error.rms = 8.7e-4;
  part.error.rms_over_sigma = 5;
  part.error.rms_over_floor = 4.9;
  part.error.steady = 1e-4;
  part.error.changing = 8.6e-4;
  part.error.largest = 2e-3;
  part.error.largest_point = 1;
  part.error.largest_time = 0.5;
  part.point_rms = Eigen::Vector2d(5e-4, 1.1e-3);
  part.worst_point = 1;
  part.in_time = {10, 300, 0.9, 0.02, 0.001};
  part.in_space = {0.5, 0.03, 0.001, {}};
  part.trends = {
      {"speed_m_per_s", 0.6, {{0, 0.004, 0.002, 50, 1e-4}, {0.004, 0.2, 0.08, 50, 4e-4}}}};
  ComparedRecording recording;
  recording.name = "swing";
  recording.noise = 1e-4;
  recording.point_names = {"root", "tip"};
  recording.noise_floor.floor = recording.noise_floor.white = 1.02e-4;
  recording.parts = {part};
  ComparisonRecord record;
  record.recordings = {recording};
  return record;
}

TEST(ComparisonReport, SaysHowLargeTheErrorIsAndThatItIsNotNoise) {
  const std::string text = DescribeComparison(Example()).at(0);
  EXPECT_THAT(text,
              HasSubstr("swing, held-out frames, 0.000 s to 1.000 s: the rms error is 0.870 mm"));
  EXPECT_THAT(text, HasSubstr("5.0 times the 0.173 mm that noise alone would give"));
  EXPECT_THAT(text, HasSubstr("The largest error is 2.000 mm (marker tip, at 0.500 s)."));
  EXPECT_THAT(text, HasSubstr("The error is not noise"));
  EXPECT_THAT(text, HasSubstr("correlation length 30 mm"));
  EXPECT_THAT(text,
              HasSubstr("grows with speed (rank correlation 0.60), from 0.100 mm at 2 mm/s to "
                        "0.400 mm at 80 mm/s."));
  EXPECT_THAT(text, Not(HasSubstr("the same in all frames")));
  EXPECT_THAT(text, Not(HasSubstr("the place where it was measured")));
}

// A perfect order of three frames comes by chance once in three times. Of ten frames, correlations
// beyond 0.794 come in one of a hundred cases (Zar, JASA 67, 1972), and the normal approximation
// asks for 0.859.
TEST(ComparisonReport, NamesNoTrendThatSoFewFramesWouldShowByChance) {
  const auto told = [](double correlation, int of_bin) {
    ComparisonRecord record = Example();
    ErrorTrend& trend = record.recordings[0].parts[0].trends[0];
    trend.rank_correlation = correlation;
    for (ErrorBin& bin : trend.bins) bin.count = of_bin;
    return DescribeComparison(record).at(0);
  };
  EXPECT_THAT(told(1, 2), HasSubstr("The error shows no clear trend"));
  EXPECT_THAT(told(0.75, 5), HasSubstr("The error shows no clear trend"));
  EXPECT_THAT(told(0.9, 5), HasSubstr("grows with speed (rank correlation 0.90)"));
  EXPECT_THAT(told(0.29, 500), HasSubstr("The error shows no clear trend")) << "but a weak one";
}

// The rms error of 0.87 mm is 5 times the noise of a typical marker; markers with more noise make
// up most of it.
TEST(ComparisonReport, SaysThatMarkersCountInUnitsOfTheirOwnNoise) {
  ComparisonRecord record = Example();
  record.recordings[0].parts[0].error.rms_over_sigma = 1.1;
  const std::string text = DescribeComparison(record).at(0);
  EXPECT_THAT(text, HasSubstr("1.1 times what noise alone would give, where each marker counts in "
                              "units of its own σ (0.100 mm per coordinate for a typical marker"));
  EXPECT_THAT(text, Not(HasSubstr("0.173 mm")));
}

// A positive delay means that the second recording shows the same motion later.
TEST(ComparisonReport, SaysInWhichDirectionARepeatIsShifted) {
  ComparisonRecord record = Example();
  record.pairs = {{"swing", "again", 100, 0.05, 2e-4}};
  EXPECT_THAT(
      DescribeComparison(record).back(),
      HasSubstr("if again is shifted 0.0500 s earlier. If both repeat the same experiment, a "
                "right model is expected to have an rms error of about 0.141 mm in each."));
  record.pairs[0].delay = -0.02;
  EXPECT_THAT(DescribeComparison(record).back(), HasSubstr("if again is shifted 0.0200 s later."));
}

TEST(ComparisonReport, ReportsADriftOnlyWhereItIsNotNoise) {
  ComparisonRecord record = Example();
  NoiseFloor& noise_floor = record.recordings[0].noise_floor;
  noise_floor.rest_deviation = 1e-4;
  noise_floor.rests = {{0, 0.1, 1e-4, 2.4e-3, 2e-3}, {0.2, 2, 1e-4, 1e-5, 2e-5}};
  const auto told = [&] {
    std::string all;
    for (const std::string& sentence : DescribeComparison(record)) all += sentence;
    return all;
  };
  EXPECT_THAT(told(), HasSubstr("(2 periods), coordinates scatter by 0.100 mm about a straight "
                                "line."));
  noise_floor.rests[1].drift = 5e-4;
  EXPECT_THAT(told(), HasSubstr("about a straight line and drift by up to 0.500 mm per second."));
}

TEST(ComparisonReport, SaysHowMuchTheFittedPlacesHide) {
  ComparisonRecord record = Example();
  record.recordings[0].parts[0].rms_at_measured_places = 1.4e-3;
  EXPECT_THAT(DescribeComparison(record).at(0),
              HasSubstr("With every marker at the place where it was measured, the rms error is "
                        "1.400 mm: the fit has moved the places within their uncertainty."));
}

TEST(ComparisonReport, TheTableHasOneLineForEachPart) {
  const std::string table = ComparisonTable(Example());
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 2);
  EXPECT_THAT(table, HasSubstr("held out"));
  EXPECT_THAT(table, HasSubstr("0.870"));
}

TEST(ComparisonReport, TheTableHasBothErrorsSideBySideAndExplainsThem) {
  ComparisonRecord record = Example();
  EXPECT_THAT(ComparisonTable(record), Not(HasSubstr("place_deviation")));
  record.recordings[0].parts[0].rms_at_measured_places = 1.4e-3;
  const std::string table = ComparisonTable(record);
  EXPECT_THAT(table, testing::ContainsRegex("rms \\(mm\\)  as measured"));
  EXPECT_THAT(table, testing::ContainsRegex("0\\.870 +1\\.400 +5\\.0"));
  EXPECT_THAT(table, HasSubstr("(place_deviation). as measured: with each marker at"));
  record.recordings[0].is_scan = true;
  EXPECT_THAT(ComparisonTable(record), HasSubstr("(scan.shape_deviation)"));
}

TEST(ComparisonReport, NamesTheLikelyCauseOfAForceAgainstTheVelocity) {
  ComparisonRecord record = Example();
  UnexplainedForceRecord force;
  force.usable = true;
  force.fit.is_significant = true;
  force.fit.converged = true;
  force.net.rms = {0, 0, 0.02};
  force.net.weight = 0.5;
  force.work = {0.3, -1.2e-3, 1e-4, -4e-3};
  force.correlations = {{"velocity", -0.9}};
  record.recordings[0].force = force;
  const std::string text = DescribeComparison(record).back();
  EXPECT_THAT(text, HasSubstr("it removes energy from the motion"));
  EXPECT_THAT(text, HasSubstr("as if the model lacks damping"));
  record.recordings[0].force->fit.is_significant = false;
  EXPECT_THAT(DescribeComparison(record).back(), HasSubstr("is not significant"));
}

TEST(QuantityText, NamesTheNearestAxisAndTheSecondOneIfItMatters) {
  EXPECT_EQ(DirectionText({0.1, 0, -1}), "−z");
  EXPECT_EQ(DirectionText({0.7, 0, -0.8}), "−z and +x");
  EXPECT_EQ(Millimetres(8.7e-4), "0.870 mm");
  EXPECT_EQ(Millimetres(5e-5), "0.05 mm");
}

}  // namespace
}  // namespace lacuna
