#include "report/calibration_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace lacuna {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

TEST(CalibrationReport, ShowsParametersErrorsAndConflicts) {
  CalibrationRecord record;
  record.noise = 1e-4;
  record.time_step = 0.002;
  record.step_error = 0.03;
  FittedParameter& parameter = record.parameters.emplace_back();
  parameter.name = "mass_damping.alpha";
  parameter.unit = "1/s";
  parameter.estimate.value = 12;
  parameter.estimate.low = 11;
  parameter.estimate.high = 13;
  parameter.estimate.posterior_deviation = 0.5;
  parameter.estimate.determination = Determination::kTradedOff;
  parameter.estimate.traded_with = "drag.coefficient";
  parameter.estimate.correlation = 0.97;
  parameter.at_limit = 14;
  parameter.with_finest_mesh = 13.8;
  parameter.near_bound = {false, 10.9};
  parameter.shares = DataShares{0.2, 0.05, 0.75};
  record.held = {{"density", "kg/m^3", {1070}}, {"gravity.acceleration", "m/s^2", {0, 0, -9.81}}};
  record.recordings.push_back({"swing", true, 1e-4, {3, 30, 1e-4, 2e-4, 1.5}, {}, std::nullopt});
  record.prior_conflicts = {MarkerConflictCount{"swing", 7, 8}};
  record.notes = {"the time step of 2 ms may be too long"};
  EXPECT_THAT(CalibrationSummary(record), HasSubstr("  note: the time step of 2 ms may be too"));
  const std::string text = CalibrationReport(record);
  EXPECT_THAT(text, HasSubstr("  note: the time step of 2 ms may be too long\n"));
  EXPECT_THAT(text, HasSubstr("traded off with drag.coefficient (correlation 0.97)"));
  EXPECT_THAT(text, HasSubstr("14 with finer elements and steps; near its lower bound 10.9"));
  EXPECT_THAT(text, HasSubstr("held fixed: density 1070 kg/m^3; gravity.acceleration [0, 0, -9.81] "
                              "m/s^2\n"));
  EXPECT_THAT(text, HasSubstr("fitted    0.100 mm (largest 0.200), 1.5 σ, 3 frames"));
  EXPECT_THAT(text, HasSubstr("held out  -"));
  EXPECT_THAT(text, ContainsRegex("with all other parameters held fixed:\n"
                                  "  parameter +markers +scans +forces\n"));
  EXPECT_THAT(text, ContainsRegex("mass_damping.alpha +20 % +5 % +75 %"));
  EXPECT_THAT(text, HasSubstr("time step 2 ms; halving it would change the prediction by 0.03 σ"));
  EXPECT_THAT(text, HasSubstr("7 of 8 markers conflict with their priors; the worst are listed"));
}

// The mesh could not be compared with another one, nor the step with half of it.
TEST(CalibrationReport, PrintsOnlyTheErrorsOfTheModelThatAreKnown) {
  CalibrationRecord record;
  record.time_step = 0.002;
  record.step_error = std::numeric_limits<double>::infinity();
  FittedParameter& parameter = record.parameters.emplace_back();
  parameter.name = "young_modulus";
  parameter.estimate.value = 12;
  parameter.estimate.posterior_deviation = 0.5;
  parameter.at_limit = 14;
  record.recordings.push_back({"swing", true, 1e-4, {3, 30, 1e-4, 2e-4, 1.5}, {}, std::nullopt});
  const std::string text = CalibrationReport(record);
  EXPECT_THAT(text, HasSubstr("14 with shorter steps"));
  EXPECT_THAT(text, HasSubstr("infinitely short time steps"));
  EXPECT_THAT(text, HasSubstr("  time step 2 ms\n"));
}

TEST(CalibrationReport, DescribesEveryConflict) {
  EXPECT_EQ(DescribePriorConflict(NuisanceParameterConflict{"swing.delay", 4.2}),
            "swing.delay is 4.2 standard deviations of its prior away from 0");
  ModelParameterConflict modulus{"young_modulus", "Pa", 3.24, 1e5, /*is_default=*/false};
  const std::string given =
      "young_modulus is 3.2 standard deviations of its prior away from the prior's mean, 1e+05 Pa";
  EXPECT_EQ(DescribePriorConflict(modulus), given);
  modulus.is_default = true;
  EXPECT_EQ(DescribePriorConflict(modulus),
            given +
                "; this prior is the default one, from the plausible range of the parameter: "
                "`mean` and `deviation` in `fit` replace it");
  EXPECT_THAT(
      DescribePriorConflict(MarkerConflict{"swing", "tip", Eigen::Vector3d(1e-3, 0, 0), 1e-4}),
      HasSubstr("the fit places marker tip (1, 0, 0) mm away from its recorded place"));
  EXPECT_THAT(DescribePriorConflict(ReferenceShapeConflict{"swing", 5, 1e-3, 1e-4}),
              HasSubstr("the tracked points are 1 mm (rms) away from the reference shape"));
  EXPECT_THAT(DescribePriorConflict(PatchConflict{"swing", 7, 8, 1e-3, 1e-4}),
              HasSubstr("7 of 8 patches are offset from the model's surface"));
  EXPECT_THAT(DescribePriorConflict(UnmatchedScans{"swing", 7, 8, 0.5, 0.85}),
              HasSubstr("in 7 of 8 frames, the first at 0.500 s, fewer than 85 %"));
}

}  // namespace
}  // namespace lacuna
