#include "record/motion_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "record/packed_array.h"
#include "record/thinning_notes.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// A closed grid of `rows` × `columns` vertices on a tube that bends over `frames` frames.
MotionRecord BendingTube(int rows, int columns, int frames) {
  MotionRecord motion;
  motion.fit = "0123";
  motion.recording = "tube";
  motion.times = Eigen::VectorXd::LinSpaced(frames, 0, 1);
  motion.up = Eigen::Vector3d::UnitZ();
  motion.triangles.resize(3, 2 * (rows - 1) * columns);
  Eigen::Index t = 0;
  for (int r = 0; r + 1 < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int a = r * columns + c, b = r * columns + (c + 1) % columns;
      motion.triangles.col(t++) << a, b, a + columns;
      motion.triangles.col(t++) << b, b + columns, a + columns;
    }
  motion.positions.resize(3 * rows * columns, frames);
  Eigen::MatrixXd lift(rows * columns, frames);
  for (int f = 0; f < frames; ++f)
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        const double along = 0.2 * r / rows, angle = 2 * std::numbers::pi * c / columns;
        lift(r * columns + c, f) = along * along * std::sin(6 * motion.times[f] + 3 * along);
        motion.positions.col(f).segment<3>(3 * (r * columns + c)) << along, 0.02 * std::cos(angle),
            0.02 * std::sin(angle) + lift(r * columns + c, f);
      }
  motion.fields = {{"lift", "lift", "m", lift}};
  return motion;
}

TEST(MotionRecord, IsReadBackAsThePageDescribesIt) {
  const TemporaryFolder folder;
  MotionRecord motion = BendingTube(5, 6, 4);
  motion.scans = {Eigen::Matrix3Xd::Zero(3, 2), Eigen::Matrix3Xd::Ones(3, 1),
                  Eigen::Matrix3Xd::Zero(3, 0), Eigen::Matrix3Xd::Zero(3, 2)};
  motion.notes = {"a note"};
  WriteMotionFile(motion, folder / "motion.json");
  const StoredMotion stored = ReadMotionFile(folder / "motion.json");
  EXPECT_EQ(stored.fit, "0123");
  EXPECT_EQ(stored.times.size(), 4u);
  EXPECT_EQ(stored.up, nlohmann::json({0.0, 0.0, 1.0}));
  EXPECT_THAT(stored.notes, testing::ElementsAre("a note"));
  EXPECT_EQ(Unpack(stored.surface.at("triangles")).values.cast<int>(), motion.triangles);
  const UnpackedArray positions = Unpack(stored.surface.at("positions"));
  EXPECT_EQ(positions.shape, (std::vector<int>{4, 30, 3}));
  // Half a step of a range of 0.2 m.
  EXPECT_LT((positions.values - motion.positions).cwiseAbs().maxCoeff(), 2e-6);
  const nlohmann::json& field = stored.surface.at("fields").at(0);
  EXPECT_EQ(field.at("unit"), "m");
  EXPECT_TRUE(field.at("diverging"));
  EXPECT_EQ(field.at("high"), motion.fields[0].values.maxCoeff());
  // Frames with fewer points are filled up.
  const UnpackedArray scans = Unpack(stored.points.at("measured"));
  EXPECT_EQ(scans.shape, (std::vector<int>{4, 2, 3}));
  EXPECT_EQ(scans.values(0, 1), 1);
  EXPECT_TRUE(std::isnan(scans.values(3, 1)));
}

TEST(MotionRecord, LargeScansAreThinnedWithANote) {
  const TemporaryFolder folder;
  MotionRecord motion = BendingTube(3, 3, 1);
  motion.scans = {Eigen::Matrix3Xd::Random(3, 2 * kMostShownPoints)};
  WriteMotionFile(motion, folder / "motion.json");
  const StoredMotion stored = ReadMotionFile(folder / "motion.json");
  EXPECT_EQ(Unpack(stored.points.at("measured")).shape[1], kMostShownPoints);
  EXPECT_THAT(stored.notes, testing::ElementsAre(testing::HasSubstr("At most 4000")));
}

TEST(MotionRecord, WhatIsNotShownIsNoted) {
  EXPECT_THAT(NotesOnThinning(20, 20, 3, 3), testing::IsEmpty());
  EXPECT_THAT(NotesOnThinning(20, 100, 3, 9),
              testing::ElementsAre("The surface is drawn with 20 of its 100 vertices.",
                                   "3 of 9 frames are drawn."));
}

TEST(MotionRecord, IsSmall) {
  const TemporaryFolder folder;
  WriteMotionFile(BendingTube(100, 100, 30), folder / "motion.json");
  const auto bytes = std::filesystem::file_size(folder / "motion.json");
  RecordProperty("bytes", std::to_string(bytes));
  EXPECT_LT(bytes, 4000000u);  // the limit for a report with 10 000 vertices and 30 frames
  EXPECT_GT(bytes, 100000u);   // it is all there
}

TEST(MotionRecord, RefusesOtherFiles) {
  const TemporaryFolder folder;
  EXPECT_THROW(ReadMotionFile(folder / "absent.json"), InputError);
  std::ofstream(folder / "other.json") << "{\"schema_version\": 1}";
  EXPECT_THROW(ReadMotionFile(folder / "other.json"), InputError);
}

}  // namespace
}  // namespace lacuna
