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

TEST(CalibrationRecord, IsReadBackAsItWasWritten) {
  CalibrationRecord record;
  record.usable = true;
  record.noise = 1e-4;
  record.step_error = INFINITY;
  FittedParameter& parameter = record.parameters.emplace_back();
  parameter.name = "material.young_modulus";
  parameter.estimate.value = 2;
  parameter.estimate.low = 1;
  parameter.estimate.verdict = ParameterEstimate::Verdict::kTradedOff;
  record.recordings.push_back({"a", true, 1e-4, {3, 30, 1e-4, 2e-4, 1.5}, {}, std::nullopt});
  record.prior_conflicts = {NuisanceParameterConflict{"a.delay", 4},
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
  ASSERT_EQ(read.parameters.size(), 1u);
  EXPECT_EQ(read.parameters[0].estimate.low, 1);
  EXPECT_EQ(read.parameters[0].estimate.high, INFINITY);
  EXPECT_EQ(read.parameters[0].estimate.verdict, ParameterEstimate::Verdict::kTradedOff);
  ASSERT_EQ(read.recordings.size(), 1u);
  EXPECT_EQ(read.recordings[0].in_fit.rms_over_sigma, 1.5);
  ASSERT_EQ(read.prior_conflicts.size(), record.prior_conflicts.size());
  for (size_t k = 0; k < read.prior_conflicts.size(); ++k)
    EXPECT_EQ(PriorConflictToJson(read.prior_conflicts[k]),
              PriorConflictToJson(record.prior_conflicts[k]));
  EXPECT_EQ(std::get<MarkerConflict>(read.prior_conflicts[1]).offset, Eigen::Vector3d(1, 2, 3));
}

TEST(CalibrationRecord, AnEarlierFormatIsRefusedWithTheCommandToRun) {
  const TemporaryFolder folder;
  std::ofstream(folder / "calibration.json") << R"({"schema_version": 1})";
  EXPECT_THAT([&] { ReadCalibrationFile(folder / "calibration.json"); },
              ThrowsMessage<InputError>(HasSubstr("run `lacuna fit` again")));
}

TEST(CalibrationRecord, AnotherFileIsRefused) {
  const TemporaryFolder folder;
  std::ofstream(folder / "calibration.json") << "{}";
  EXPECT_THAT([&] { ReadCalibrationFile(folder / "calibration.json"); },
              ThrowsMessage<InputError>(HasSubstr("is not a record of a calibration")));
}

}  // namespace
}  // namespace lacuna
