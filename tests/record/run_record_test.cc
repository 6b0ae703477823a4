#include "record/run_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "core/error.h"
#include "record/csv_table.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

RunRecord Example() {
  RunRecord record;
  record.recording = "bend";
  record.object_size = 0.125;
  record.animation_residual = 0.25;
  record.forces = RunForces::kKnown;
  record.relative_animation_residual = 2;
  record.mesh = {100, 300, 2, 1e-4, 0.3, 1.4};
  record.stages["fit"] = {true, "converged", "", 12};
  record.measures["truth_mean_distance_m"] = 1e-4;
  record.warnings = {"frame 1 is empty", "sized in \"mm\"?"};
  for (int k = 0; k < 2; ++k) {
    FrameRecord frame;
    frame.frame = k;
    frame.time = 0.1 * k;
    frame.residual = 0.001 * k;
    frame.residual_mean = 0.0005 * k;
    frame.relative_residual = 0.008 * k;
    frame.surface_distance_mean = 1e-4;
    frame.surface_distance_rms = 2e-4;
    frame.surface_distance_max = 3e-4;
    frame.relative_surface_distance = 8e-4;
    frame.force_resultant = Eigen::Vector3d(1, 2, 3 + k);
    frame.force_resultant_deviation = Eigen::Vector3d(0.1, 0.2, 0.3 * k);
    frame.torque_resultant = {4, 5, 6};
    frame.solver = {true, "converged", "in frame " + std::to_string(k), 5 + k};
    record.frames.push_back(frame);
  }
  record.point_residuals = Eigen::MatrixXd::Random(5, 2);
  return record;
}

TEST(RunRecordTest, IsReadBackCompletely) {
  const TemporaryFolder folder;
  RunRecord written = Example();
  written.frames_not_tried = 3;
  WriteRunRecord(written, folder.Path());
  const RunRecord read = ReadRunRecord(folder.Path());
  EXPECT_EQ(read.recording, written.recording);
  EXPECT_EQ(read.object_size, written.object_size);
  EXPECT_EQ(read.animation_residual, written.animation_residual);
  EXPECT_EQ(read.forces, written.forces);
  EXPECT_EQ(read.frames_not_tried, 3);
  EXPECT_EQ(read.relative_animation_residual, written.relative_animation_residual);
  EXPECT_EQ(read.mesh.node_count, 100);
  EXPECT_EQ(read.mesh.tet_count, 300);
  EXPECT_EQ(read.mesh.order, 2);
  EXPECT_EQ(read.mesh.volume, 1e-4);
  EXPECT_EQ(read.mesh.smallest_angle, 0.3);
  EXPECT_EQ(read.mesh.largest_radius_edge_ratio, 1.4);
  EXPECT_EQ(read.stages.at("fit").iterations, 12);
  EXPECT_EQ(read.measures, written.measures);
  EXPECT_EQ(read.warnings, written.warnings);
  ASSERT_EQ(read.frames.size(), 2u);
  for (size_t k = 0; k < 2; ++k) {
    const FrameRecord &a = read.frames[k], &b = written.frames[k];
    EXPECT_EQ(a.frame, b.frame);
    EXPECT_EQ(a.time, b.time);
    EXPECT_EQ(a.residual, b.residual);
    EXPECT_EQ(a.residual_mean, b.residual_mean);
    EXPECT_EQ(a.relative_residual, b.relative_residual);
    EXPECT_EQ(a.surface_distance_mean, b.surface_distance_mean);
    EXPECT_EQ(a.surface_distance_rms, b.surface_distance_rms);
    EXPECT_EQ(a.surface_distance_max, b.surface_distance_max);
    EXPECT_EQ(a.relative_surface_distance, b.relative_surface_distance);
    EXPECT_EQ(a.force_resultant, b.force_resultant);
    EXPECT_EQ(a.force_resultant_deviation, b.force_resultant_deviation);
    EXPECT_EQ(a.torque_resultant, b.torque_resultant);
    EXPECT_EQ(a.solver.usable, b.solver.usable);
    EXPECT_EQ(a.solver.status, b.solver.status);
    EXPECT_EQ(a.solver.message, b.solver.message);
    EXPECT_EQ(a.solver.iterations, b.solver.iterations);
  }
  EXPECT_EQ(read.point_residuals, written.point_residuals);
}

TEST(RunRecordTest, UnmeasuredValuesAreReadBackAsNotMeasured) {
  const TemporaryFolder folder;
  RunRecord empty;
  empty.frames.resize(1);
  WriteRunRecord(empty, folder.Path());
  const RunRecord read = ReadRunRecord(folder.Path());
  EXPECT_TRUE(std::isnan(read.object_size));
  EXPECT_TRUE(std::isnan(read.frames[0].residual));
  EXPECT_TRUE(read.frames[0].force_resultant.array().isNaN().all());
  EXPECT_EQ(read.frames[0].solver.status, "not run");
  EXPECT_EQ(read.point_residuals.size(), 0);
}

TEST(RunRecordTest, IsUsableOnlyWhenEveryStageAndFrameIs) {
  EXPECT_FALSE(RunRecord().IsUsable());
  RunRecord record = Example();
  EXPECT_TRUE(record.IsUsable());
  record.frames_not_tried = 1;
  EXPECT_FALSE(record.IsUsable()) << "it ended early";
  record.frames_not_tried = 0;
  record.frames[1].solver.usable = false;
  EXPECT_FALSE(record.IsUsable());
  record = Example();
  record.stages["surface"] = {};
  EXPECT_FALSE(record.IsUsable());
}

TEST(RunRecordTest, FramesAreAlsoWrittenAsATable) {
  const TemporaryFolder folder;
  WriteRunRecord(Example(), folder.Path());
  const CsvTable table = ReadCsv(folder / "frames.csv");
  const auto column = [&table](const std::string& name) {
    for (const CsvColumn& c : table) {
      if (c.name == name) return c.values;
    }
    ADD_FAILURE() << "no column " << name;
    return Eigen::VectorXd();
  };
  EXPECT_EQ(column("frame"), Eigen::Vector2d(0, 1));
  EXPECT_EQ(column("residual_m"), Eigen::Vector2d(0, 0.001));
  EXPECT_EQ(column("force_z_N"), Eigen::Vector2d(3, 4));
  EXPECT_EQ(column("torque_x_Nm"), Eigen::Vector2d(4, 4));
  EXPECT_EQ(column("usable"), Eigen::Vector2d(1, 1));
}

TEST(RunRecordTest, DamagedRecordsAreRefused) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { ReadRunRecord(folder.Path()); },
              ThrowsMessage<InputError>(HasSubstr("no such file")));
  std::ofstream(folder / "record.json") << "{\"schema_version\": 1}";
  EXPECT_THAT([&] { ReadRunRecord(folder.Path()); },
              ThrowsMessage<InputError>(HasSubstr("is not a valid record")));
  std::ofstream(folder / "record.json") << "{\"schema_version\": 2}";
  EXPECT_THAT([&] { ReadRunRecord(folder.Path()); },
              ThrowsMessage<InputError>(HasSubstr("has schema_version 2; expected 1")));
}

TEST(RunRecordDeathTest, InconsistentRecordsAreNotWritten) {
  const TemporaryFolder folder;
  RunRecord record = Example();
  record.point_residuals.resize(5, 3);
  EXPECT_DEATH(WriteRunRecord(record, folder.Path()), "Check failed");
  record = Example();
  record.frames[0].residual = std::numeric_limits<double>::infinity();
  EXPECT_DEATH(WriteRunRecord(record, folder.Path()), "infinite measure");
}

}  // namespace
}  // namespace lacuna
