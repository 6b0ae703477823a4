// What is measured of a model that follows markers: the residual D and the errors of held-out and
// true points.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "geometry/mesh_io.h"
#include "reconstruction/followed_markers.h"
#include "reconstruction/residual_at_vertices.h"
#include "reconstruction/shown_reconstruction.h"

namespace lacuna {
namespace {

using testing::Contains;
using testing::HasSubstr;

// The body is clamped and no force acts: it stays where it is, and D is the motion of the markers,
// also where they are too few for CPD.
TEST(MarkerMotion, TheResidualOfIdentifiedMarkersIsTheirDistanceFromTheModel) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 4, {0, 0, 0.002}, [](int) { return true; }, kClamped);
  const FollowedMarkers followed = Follow(folder, "");
  ASSERT_EQ(followed.record.frames.size(), 3u);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(followed.record.frames[k].residual_mean, 0.002 * k, 1e-9);
    EXPECT_NEAR(followed.record.frames[k].residual, 4 * 0.002 * k, 1e-9);
  }
  EXPECT_NEAR(followed.record.animation_residual, 4 * 0.006, 1e-9);
  EXPECT_EQ(followed.record.measures.at("residual_frames"), 3);
  EXPECT_THAT(followed.record.warnings, testing::Not(Contains(HasSubstr("registration"))));
  const Eigen::Matrix3Xd at_vertices =
      ResidualAtVertices(followed.study, followed.states, followed.motion)
          .Of(followed.motion.frames[1]);
  ASSERT_EQ(at_vertices.cols(), followed.motion.body->boundary.node.size());
  EXPECT_LT((at_vertices.colwise() - Eigen::Vector3d(0, 0, 0.002)).norm(), 1e-9);
  const MotionRecord shown = ShownReconstruction(followed.study, followed.states, followed.motion);
  EXPECT_THAT(shown.fields.at(0).label, HasSubstr("nearest tracked point"));
}

// Nothing moves the model, so that D of frame 1, the first that is followed, is the motion of the
// markers since the undeformed state, which is not shown.
TEST(MarkerMotion, MarkersAreComparedWithTheirPlacesOnTheUndeformedBody) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 4, {0, 0, 0.002}, [](int) { return true; }, kClamped);
  const FollowedMarkers followed =
      Follow(folder, "frames: {first: 1}\nvalidation: {hold_out_every: 2}\n");
  ASSERT_EQ(followed.record.frames.size(), 2u);
  EXPECT_NEAR(followed.record.frames[0].residual_mean, 0.002, 1e-9);
  EXPECT_NEAR(followed.record.frames[1].residual_mean, 0.004, 1e-9);
  EXPECT_NEAR(followed.record.measures.at("held_out_rms_max_m"), 0.004, 1e-9);
  EXPECT_EQ(followed.record.measures.at("held_out_points"), 2);
}

TEST(MarkerMotion, ARunThatEndedEarlyHasNoSumOverAllFrames) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 4, {0, 0, 0.002}, [](int) { return true; }, kClamped);
  const FollowedMarkers followed = Follow(folder, "");
  ASSERT_FALSE(std::isnan(followed.record.animation_residual));
  FollowedMotion motion = followed.motion;
  motion.frames.back().solver.usable = false;
  const auto measured = [&] {
    return MeasureRun(followed.study, followed.reference, followed.states, motion);
  };
  EXPECT_TRUE(std::isnan(measured().animation_residual));
  EXPECT_EQ(measured().measures.at("residual_frames"), 2);
  EXPECT_NEAR(measured().measures.at("residual_per_point_m"), 0.001, 1e-9);
  motion.frames.resize(1);
  motion.frames[0].solver.usable = false;
  EXPECT_TRUE(std::isnan(measured().animation_residual)) << "nothing was followed";
}

TEST(MarkerMotion, AModelThatStaysFarFromItsMarkersIsReported) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 6, {0, 0, 0.005}, [](int m) { return m > 0; }, kClamped);
  // Forces of this scale are too small to move the bar.
  const FollowedMarkers far =
      Follow(folder, "fit: {noise: 0.1 mm}\n",
             "{model: footprint, force_scale: 1e-9 N, region: {half_space: {point: [0.07 m, 0 m, 0 "
             "m], normal: [1, 0, 0]}}}");
  ASSERT_EQ(far.motion.frames.size(), 3u);
  EXPECT_THAT(far.record.warnings,
              Contains(testing::AllOf(HasSubstr("in 2 of 3 followed frames the model stays far"),
                                      HasSubstr("in frame 2, half of them are farther than 10 mm"),
                                      HasSubstr("100 times the noise"))));
  // Without forces the distance is the result.
  EXPECT_THAT(Follow(folder, "").record.warnings,
              testing::Not(Contains(HasSubstr("stays far from the tracked points"))));
}

TEST(MarkerMotion, TheResidualOfMarkersThatAreTooFewForARegistrationIsNotZero) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 4, {0, 0, 0.002}, [](int) { return true; }, kClamped);
  const FollowedMarkers followed = Follow(folder, "fit: {noise: 0.1 mm, use_identity: false}\n");
  ASSERT_EQ(followed.record.frames.size(), 3u);
  for (const FrameRecord& frame : followed.record.frames) {
    EXPECT_TRUE(frame.solver.usable);
    EXPECT_TRUE(std::isnan(frame.residual));
    EXPECT_TRUE(std::isnan(frame.residual_mean));
    EXPECT_FALSE(std::isnan(frame.surface_distance_mean));
  }
  EXPECT_TRUE(std::isnan(followed.record.animation_residual));
  EXPECT_TRUE(std::isnan(followed.record.relative_animation_residual));
  EXPECT_EQ(followed.record.measures.at("residual_frames"), 0);
  EXPECT_EQ(followed.record.measures.count("residual_per_point_m"), 0u);
  EXPECT_EQ(followed.record.measures.count("noise_m"), 0u);
  EXPECT_THAT(followed.record.warnings,
              Contains(HasSubstr("|D| was not measured in 3 of 3 followed frames (the first is "
                                 "frame 0: too few points")));

  // The files of the stage keep the reason.
  const TemporaryFolder& files = folder;
  WriteFollowedMotion(followed.motion, files.Path());
  const FollowedMotion read = ReadFollowedMotion(followed.study, followed.reference, files.Path());
  EXPECT_TRUE(std::isnan(read.noise));
  ASSERT_EQ(read.frames.size(), 3u);
  EXPECT_EQ(read.frames[1].residual_problem, followed.motion.frames[1].residual_problem);
  EXPECT_TRUE(read.frames[1].residual.array().isNaN().all());
}

TEST(MarkerMotion, HeldOutPointsThatAreNeverSeenHaveNoError) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 4, {0, 0, 0.002}, [](int) { return true; }, kClamped);
  FollowedMarkers followed = Follow(folder, "validation: {hold_out_every: 4}\n");
  EXPECT_EQ(followed.record.measures.at("held_out_points"), 1);
  EXPECT_EQ(followed.record.measures.count("held_out_spacing_m"), 1u);
  for (FrameState& state : followed.states)
    state.held_out.setConstant(std::numeric_limits<double>::quiet_NaN());
  const RunRecord unseen =
      MeasureRun(followed.study, followed.reference, followed.states, followed.motion);
  EXPECT_EQ(unseen.measures.at("held_out_points"), 0);
  EXPECT_EQ(unseen.measures.count("held_out_rms_max_m"), 0u);
  EXPECT_EQ(unseen.measures.count("held_out_spacing_m"), 0u);
}

TEST(MarkerMotion, OnePointAloneHasNoSpacing) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 4, {0, 0, 0.002}, [](int) { return true; }, kClamped);
  FollowedMarkers followed = Follow(folder, "validation: {hold_out_every: 4}\n");
  // The places of the others are not known.
  followed.study.recording.markers.places.leftCols(3).setConstant(
      std::numeric_limits<double>::quiet_NaN());
  followed.states[0].tracked.setConstant(std::numeric_limits<double>::quiet_NaN());
  const RunRecord alone =
      MeasureRun(followed.study, followed.reference, followed.states, followed.motion);
  EXPECT_EQ(alone.measures.count("held_out_rms_max_m"), 1u);
  EXPECT_EQ(alone.measures.count("held_out_spacing_m"), 0u);
}

// The points as a file of true positions that do not change in any of `frames`.
void WriteResting(const std::filesystem::path& file, const Eigen::Matrix3Xd& points, int frames) {
  std::string header = fmt::format(
      "{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, {}, 3), }}", frames, points.cols());
  header.resize(117, ' ');
  std::ofstream stream(file, std::ios::binary);
  stream << "\x93NUMPY" << '\x01' << '\0' << '\x76' << '\0' << header << '\n';
  for (int frame = 0; frame < frames; ++frame)
    stream.write(reinterpret_cast<const char*>(points.data()), 8 * points.size());
}

TEST(MarkerMotion, TruePointsAtRestHaveNoRelativeError) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 4, {0, 0, 0.002}, [](int) { return true; }, kClamped);
  const TetMesh mesh = BoxMesh({0, -0.01, -0.01}, {0.08, 0.01, 0.01}, {2, 1, 1});
  WriteTetMesh(folder / "true.msh", mesh);
  WriteResting(folder / "true.npy", mesh.nodes, 3);
  const FollowedMarkers followed =
      Follow(folder, "validation: {true_mesh: " + (folder / "true.msh").string() +
                         ", true_positions: " + (folder / "true.npy").string() + "}\n");
  EXPECT_EQ(followed.record.measures.at("true_displacement_max_m"), 0);
  EXPECT_NEAR(followed.record.measures.at("true_position_mean_error_m"), 0, 1e-9);
  EXPECT_EQ(followed.record.measures.count("true_position_mean_error"), 0u);
}

}  // namespace
}  // namespace lacuna
