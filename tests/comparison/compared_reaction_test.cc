// A comparison tells the errors of measured forces apart from those of the markers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "calibration/calibration_run.h"
#include "comparison/run_comparison.h"
#include "prediction/prediction_study_reader.h"
#include "report/calibration_report.h"
#include "report/comparison_report.h"
#include "support/pulled_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::Contains;
using testing::ContainsRegex;
using testing::HasSubstr;

TEST(ComparedReaction, IsListedInNewtonsAndInItsNoise) {
  const TemporaryFolder folder;
  WritePulledBar(folder.Path(), {});
  std::ofstream(folder / "study.yaml") << PulledBarExperiment(folder.Path());
  SilentProgress progress;
  const CalibrationRecord fit =
      RunCalibration(ReadPredictionStudy(Config::Load(folder / "study.yaml")), &progress);
  ASSERT_TRUE(fit.usable) << fit.message;
  EXPECT_THAT(CalibrationReport(fit), HasSubstr("force on jaw"));
  EXPECT_THAT(CalibrationReport(fit), ContainsRegex("young_modulus +0 % +0 % +100 %"));

  const Comparison comparison = CompareRun(folder / "run");
  WriteComparisonFile(comparison.record, {}, folder / "comparison.json");
  const ComparisonRecord read = ReadComparisonFile(folder / "comparison.json");
  const FittedReaction& jaw = read.recordings.at(0).reactions.at(0);
  EXPECT_EQ(jaw.in_fit.rms, fit.recordings[0].reactions.at(0).in_fit.rms);
  EXPECT_GT(jaw.in_fit.rms, 0.003);  // N; the noise is 0.01 N
  EXPECT_LT(jaw.in_fit.rms, 0.02);
  // The geometric error is that of the markers, as without a load cell.
  EXPECT_LT(read.recordings[0].parts.at(0).error.rms_over_sigma, 1.3);
  EXPECT_THAT(DescribeComparison(read),
              Contains(HasSubstr("force on jaw (x; the largest reading")));
}

}  // namespace
}  // namespace lacuna
