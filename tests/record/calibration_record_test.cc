#include "record/calibration_record.h"

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

TEST(CalibrationRecord, NoSingleNoiseHoldsForScans) {
  CalibrationRecord record;
  record.noise = 1e-4;
  record.recordings.resize(2);
  EXPECT_DOUBLE_EQ(RmsOfNoise(record).value(), std::sqrt(3.0) * 1e-4);
  record.recordings[1].scan.emplace();
  EXPECT_EQ(RmsOfNoise(record), std::nullopt);
}

TEST(CalibrationRecord, IsReadBackAsItWasWritten) {
  CalibrationRecord record;
  record.usable = true;
  record.noise = 1e-4;
  record.step_error = INFINITY;
  record.notes = {"the time step may be too long"};
  FittedParameter& parameter = record.parameters.emplace_back();
  parameter.name = "material.young_modulus";
  parameter.estimate.value = 2;
  parameter.estimate.low = 1;
  parameter.estimate.determination = Determination::kTradedOff;
  parameter.near_bound = {true, 2.5};
  parameter.shares = DataShares{0.2, 0.05, 0.75};
  record.held = {{"density", "kg/m^3", {1070}}, {"gravity.acceleration", "m/s^2", {0, 0, -9.81}}};
  record.recordings.push_back({"a", true, 1e-4, {3, 30, 1e-4, 2e-4, 1.5}, {}, std::nullopt});
  record.recordings[0].marker_names = {"root", "tip"};
  record.recordings[0].reactions.push_back({"jaw",
                                            true,
                                            true,
                                            {"x", "z"},
                                            0.02,
                                            true,
                                            0.1,
                                            {0.05, -0.03},
                                            3,
                                            {4, 8, 0.03, 0.06, 1.5},
                                            {},
                                            {-2, 0.4, 0.1}});
  record.prior_conflicts = {NuisanceParameterConflict{"a.delay", 4},
                            ModelParameterConflict{"drag.linear", "kg/s", 3.2, 1, true},
                            MarkerConflict{"a", "tip", Eigen::Vector3d(1, 2, 3), 1e-4},
                            MarkerConflictCount{"a", 7, 8},
                            ReferenceShapeConflict{"a", 5, 1e-3, 1e-4},
                            PatchConflict{"a", 7, 8, 1e-3, 1e-4},
                            UnmatchedScans{"a", 7, 8, 0.5, 0.85}};
  ASSERT_EQ(record.prior_conflicts.size(), std::variant_size_v<PriorConflict>);
  const TemporaryFolder folder;
  WriteCalibrationFile(record, folder / "calibration.json");
  const CalibrationRecord read = ReadCalibrationFile(folder / "calibration.json");
  EXPECT_TRUE(read.usable);
  EXPECT_EQ(read.step_error, INFINITY);
  EXPECT_EQ(read.notes, record.notes);
  ASSERT_EQ(read.parameters.size(), 1u);
  EXPECT_EQ(read.parameters[0].estimate.low, 1);
  EXPECT_EQ(read.parameters[0].estimate.high, INFINITY);
  EXPECT_EQ(read.parameters[0].estimate.determination, Determination::kTradedOff);
  ASSERT_TRUE(read.parameters[0].near_bound);
  EXPECT_TRUE(read.parameters[0].near_bound->is_upper);
  EXPECT_EQ(read.parameters[0].near_bound->bound, 2.5);
  ASSERT_EQ(read.held.size(), 2u);
  EXPECT_EQ(read.held[1].name, "gravity.acceleration");
  EXPECT_EQ(read.held[1].unit, "m/s^2");
  EXPECT_EQ(read.held[1].values, (std::vector<double>{0, 0, -9.81}));
  ASSERT_EQ(read.recordings.size(), 1u);
  EXPECT_EQ(read.recordings[0].in_fit.rms_over_sigma, 1.5);
  ASSERT_TRUE(read.parameters[0].shares);
  EXPECT_EQ(read.parameters[0].shares->markers, 0.2);
  EXPECT_EQ(read.parameters[0].shares->scans, 0.05);
  EXPECT_EQ(read.parameters[0].shares->forces, 0.75);
  EXPECT_EQ(read.recordings[0].marker_names, (std::vector<std::string>{"root", "tip"}));
  ASSERT_EQ(read.recordings[0].reactions.size(), 1u);
  EXPECT_EQ(read.recordings[0].reactions[0].likely_mistakes.delay, 0.1);
  EXPECT_EQ(ReactionToJson(read.recordings[0].reactions[0]),
            ReactionToJson(record.recordings[0].reactions[0]));
  ASSERT_EQ(read.prior_conflicts.size(), record.prior_conflicts.size());
  for (size_t k = 0; k < read.prior_conflicts.size(); ++k)
    EXPECT_EQ(PriorConflictToJson(read.prior_conflicts[k]),
              PriorConflictToJson(record.prior_conflicts[k]));
  EXPECT_TRUE(std::get<ModelParameterConflict>(read.prior_conflicts[1]).is_default);
  EXPECT_EQ(std::get<MarkerConflict>(read.prior_conflicts[2]).offset, Eigen::Vector3d(1, 2, 3));
}

TEST(CalibrationRecord, AnEarlierFormatIsRefusedWithTheCommandToRun) {
  const TemporaryFolder folder;
  std::ofstream(folder / "calibration.json") << R"({"schema_version": 1})";
  EXPECT_THAT([&] { ReadCalibrationFile(folder / "calibration.json"); },
              ThrowsMessage<InputError>(HasSubstr("run `lacuna fit` again")));
}

TEST(CalibrationRecord, FindsTheBoundThatAnIntervalComesNear) {
  const auto near = [](double low, double value, double high, bool log_scale, double min,
                       double max) {
    ParameterEstimate estimate;
    estimate.value = value;
    estimate.low = low;
    estimate.high = high;
    const auto found = FindNearBound(estimate, log_scale, min, max);
    return !found ? 0 : found->is_upper ? 1 : -1;
  };
  // Poisson's ratio: 1 % of its range is 0.015.
  EXPECT_EQ(near(0.47, 0.48, 0.484, false, -1, 0.5), 0);
  EXPECT_EQ(near(0.47, 0.48, 0.486, false, -1, 0.5), 1);
  EXPECT_EQ(near(0.4996, 0.4997, 0.4998, false, -1, 0.5), 1);
  EXPECT_EQ(near(-0.99, 0.2, 0.3, false, -1, 0.5), -1);
  // On a logarithmic scale from 1 to 1000, 1 % of the range is a factor of 1.07.
  EXPECT_EQ(near(1.06, 5, 9, true, 1, 1000), -1);
  EXPECT_EQ(near(1.08, 5, 9, true, 1, 1000), 0);
  // Without an upper bound, or with a lower bound of 0 on a logarithmic scale.
  EXPECT_EQ(near(1e-9, 1, 2, false, 0, INFINITY), 0);
  EXPECT_EQ(near(-0.1, 1, 2, false, 0, INFINITY), -1);
  EXPECT_EQ(near(1e-9, 1, 2, true, 0, INFINITY), 0);
  // What the data do not determine.
  EXPECT_EQ(near(-INFINITY, 1, INFINITY, false, 0, 2), 0);
  EXPECT_EQ(near(-3, 1, 4, false, 0, 2), 0);
}

TEST(CalibrationRecord, AnotherFileIsRefused) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { ReadCalibrationFile(folder / "calibration.json"); },
              ThrowsMessage<InputError>(HasSubstr("cannot be read: no such file")));
  std::ofstream(folder / "calibration.json") << "{}";
  EXPECT_THAT([&] { ReadCalibrationFile(folder / "calibration.json"); },
              ThrowsMessage<InputError>(HasSubstr("is not a record of a calibration")));
}

}  // namespace
}  // namespace lacuna
