// Reconstructions of markers: points that identify themselves, some of which move the model.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "experiment/reference_body.h"
#include "reconstruction/follow.h"
#include "reconstruction/reconstruction_measures.h"
#include "reconstruction/recorded_states.h"
#include "reconstruction/residual_at_vertices.h"
#include "reconstruction/shown_reconstruction.h"
#include "support/marker_recording.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::Contains;
using testing::HasSubstr;

// Markers on the upper side of a bar of 80 × 20 × 20 mm, alternately on its two edges.
Eigen::Matrix3Xd PlacesOnBar(int count) {
  Eigen::Matrix3Xd places(3, count);
  for (int m = 0; m < count; ++m)
    places.col(m) << 0.005 + 0.07 * m / (count - 1), m % 2 == 0 ? 0.01 : -0.01, 0.01;
  return places;
}

// Three frames in which those markers for which moves(m) holds move by `step` in each. `held` is
// the entry of recording.yaml that says what holds the bar at x = 0. The first frame does not show
// the marker `hidden`.
template <typename Moves>
void WriteMarkers(const TemporaryFolder& folder, int count, const Eigen::Vector3d& step,
                  const Moves& moves, const std::string& held, int hidden = -1) {
  WriteBoxSurface(folder / "box.off", {0, -0.01, -0.01}, {0.08, 0.01, 0.01});
  const Eigen::Matrix3Xd places = PlacesOnBar(count);
  std::ofstream csv(folder / "markers.csv");
  csv << "t";
  for (int m = 0; m < count; ++m) csv << fmt::format(",m{0}_x,m{0}_y,m{0}_z", m);
  for (int frame = 0; frame < 3; ++frame) {
    csv << "\n" << frame;
    for (int m = 0; m < count; ++m) {
      if (frame == 0 && m == hidden) {
        csv << ",,,";
        continue;
      }
      const Eigen::Vector3d at =
          places.col(m) + (moves(m) ? frame * step : Eigen::Vector3d(0, 0, 0));
      csv << fmt::format(",{},{},{}", at.x(), at.y(), at.z());
    }
  }
  csv << "\n";
  std::ofstream(folder / "recording.yaml")
      << "schema_version: 1\nname: bar\nlength_unit: m\ndensity: 1000 kg/m^3\n"
      << MarkerFrames(places) << held
      << ", half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}}]\n"
      << "reference: {from: mesh, file: box.off}\n";
}

struct FollowedMarkers {
  ReconstructionStudy study;
  std::vector<FrameState> states;
  ReferenceBody reference;
  FollowedMotion motion;
  RunRecord record;
};

// One force at the end of the bar.
constexpr char kTipForce[] =
    "{model: footprint, force_scale: 0.01 N, region: {half_space: {point: [0.07 m, 0 m, 0 m], "
    "normal: [1, 0, 0]}}}";

// Follows them with these forces; `more` is added to the experiment.
FollowedMarkers Follow(const TemporaryFolder& folder, const std::string& more,
                       const std::string& forces = "{model: none}",
                       const std::string& motion = "{scheme: quasi_static}") {
  SilentProgress progress;
  FollowedMarkers followed;
  followed.study = ReadReconstruction(Config::Parse(
      "schema_version: 1\nname: markers\nrecording: " + folder.Path().string() +
          "\nmesh: {max_volume: 4000 mm^3}\nmaterial: {law: linear, young_modulus: 0.1 MPa, "
          "poisson_ratio: 0.3}\nmotion: " +
          motion + "\nforces: " + forces + "\n" + more,
      "markers.yaml"));
  followed.states = LoadFrameStates(followed.study, &progress);
  followed.reference = MakeReferenceBody(followed.study, followed.states.front());
  followed.motion = FollowFrames(followed.study, followed.reference, followed.states, &progress);
  followed.record =
      MeasureRun(followed.study, followed.reference, followed.states, followed.motion);
  return followed;
}

constexpr char kClamped[] = "fixed: [{name: clamp";

TEST(MarkerMotion, AGripFollowsItsOwnMarkersWhenOthersAreHeldOut) {
  const TemporaryFolder folder;
  const Eigen::Vector3d step(0, 0.001, 0);
  // Without every second marker, columns 2 and 4 belong to m4 and m8, and m8 does not move.
  WriteMarkers(
      folder, 12, step, [](int m) { return m == 2 || m == 4; },
      "gripped: [{name: hand, follows_markers: [m2, m4]");
  const FollowedMarkers followed =
      Follow(folder, "fit: {noise: 0.1 mm}\nvalidation: {hold_out_every: 2}\n");
  EXPECT_EQ(followed.states.front().held_out.cols(), 6);
  ASSERT_EQ(followed.motion.frames.size(), 3u);
  const FollowedFrame& last = followed.motion.frames.back();
  ASSERT_TRUE(last.solver.usable) << last.solver.message;
  const Eigen::Matrix3Xd& rest = followed.motion.body->mesh.nodes;
  int held = 0;
  for (Eigen::Index i = 0; i < rest.cols(); ++i) {
    if (rest(0, i) > 0.002) continue;
    ++held;
    EXPECT_LT((last.position.col(i) - rest.col(i) - 2 * step).norm(), 1e-9) << i;
  }
  EXPECT_GE(held, 4);
}

TEST(MarkerMotion, MarkersThatAGripFollowsAreNotHeldOut) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 8, {0, 0.001, 0}, [](int) { return true; },
      "gripped: [{name: hand, follows_markers: [m1, m3, m5]");
  const FollowedMarkers followed =
      Follow(folder, "fit: {noise: 0.1 mm}\nvalidation: {hold_out_every: 2}\n");
  EXPECT_EQ(followed.states.front().tracked.cols(), 7);
  ASSERT_EQ(followed.states.front().held_out.cols(), 1);
  EXPECT_LT((followed.states.front().held_out.col(0) - PlacesOnBar(8).col(7)).norm(), 1e-9);
}

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

TEST(MarkerMotion, ForcesAreFittedWhereTheFirstFrameDoesNotShowAMarker) {
  const TemporaryFolder folder;
  constexpr int kHidden = 2;
  WriteMarkers(
      folder, 6, {0, 0, 0.001}, [](int m) { return m >= 4; }, kClamped, kHidden);
  const FollowedMarkers followed = Follow(folder, "fit: {noise: 0.1 mm}\n", kTipForce);
  ASSERT_EQ(followed.motion.frames.size(), 3u);
  for (const FollowedFrame& frame : followed.motion.frames) {
    ASSERT_TRUE(frame.solver.usable) << frame.solver.message;
    EXPECT_EQ(frame.observations, 5);
    EXPECT_TRUE(frame.residual.col(kHidden).array().isNaN().all());
    EXPECT_EQ(frame.residual.array().isNaN().count(), 3);
  }
  const FollowedFrame& last = followed.motion.frames.back();
  EXPECT_GT(last.force.row(2).sum(), 0);
  // The tip follows its marker, which moves by 2 mm, as far as the marker at rest beside it allows.
  EXPECT_LT(last.residual.col(5).norm(), 0.0018);
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

TEST(MarkerMotion, ADynamicMotionBeginsAtTheEquilibriumOfTheFirstFrame) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 6, {0, 0, 0.001}, [](int m) { return m >= 4; }, kClamped);
  const FollowedMarkers followed = Follow(folder, "fit: {noise: 0.1 mm}\n", kTipForce, "{}");
  ASSERT_NE(followed.study.follow.scheme, TimeScheme::kQuasiStatic) << "the default has inertia";
  ASSERT_EQ(followed.motion.frames.size(), 3u);
  for (const FollowedFrame& frame : followed.motion.frames)
    EXPECT_TRUE(frame.solver.usable) << frame.solver.message;
  EXPECT_LT(followed.motion.frames[0].residual.cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_GT(followed.motion.frames[2].force.row(2).sum(), 0);
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
  SaveFollowedMotion(followed.motion, files.Path());
  const FollowedMotion read = ReadFollowedMotion(followed.study, followed.reference, files.Path());
  EXPECT_TRUE(std::isnan(read.noise));
  ASSERT_EQ(read.frames.size(), 3u);
  EXPECT_EQ(read.frames[1].residual_problem, followed.motion.frames[1].residual_problem);
  EXPECT_TRUE(read.frames[1].residual.array().isNaN().all());
}

TEST(MarkerMotion, TheNoiseOfMarkersMustBeGivenWhereItCannotBeEstimated) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 4, {0, 0, 0.002}, [](int) { return true; }, kClamped);
  const auto follow = [&](const std::string& more) {
    return [&, more] { Follow(folder, more, kTipForce); };
  };
  EXPECT_THAT(follow("fit: {use_identity: false}\n"),
              testing::ThrowsMessage<InputError>(
                  testing::AllOf(HasSubstr("markers.yaml:"), HasSubstr("fit.noise: must be given"),
                                 HasSubstr("markers are too far apart"))));
  EXPECT_THAT(follow("frames: {last: 1}\n"),
              testing::ThrowsMessage<InputError>(testing::AllOf(
                  HasSubstr("fit: noise must be given"), HasSubstr("2 are followed"))));
}

TEST(MarkerMotion, NoNoiseIsNeededWhereNoForcesAreFitted) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 4, {0, 0, 0.002}, [](int) { return true; }, kClamped);
  for (const char* more : {"frames: {last: 1}\n", "fit: {use_identity: false}\n"}) {
    const FollowedMarkers followed = Follow(folder, more);
    EXPECT_TRUE(followed.motion.frames.back().solver.usable) << more;
    EXPECT_TRUE(std::isnan(followed.motion.noise)) << more;
    EXPECT_EQ(followed.record.measures.count("noise_m"), 0u) << more;
  }
  const FollowedMarkers fitted = Follow(folder, "fit: {noise: 0.1 mm}\n", kTipForce);
  EXPECT_EQ(fitted.record.measures.at("noise_m"), 1e-4);
}

// Four points are too few for CPD, so that no force could be fitted to them.
TEST(MarkerMotion, PointsThatCannotBeRegisteredObserveNothing) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 4, {0, 0, 0.002}, [](int) { return true; }, kClamped);
  const FollowedMarkers followed =
      Follow(folder, "fit: {noise: 0.1 mm, use_identity: false}\n", kTipForce);
  ASSERT_EQ(followed.motion.frames.size(), 1u);
  EXPECT_FALSE(followed.motion.frames[0].solver.usable);
  EXPECT_THAT(followed.motion.frames[0].solver.message, HasSubstr("no observation"));
  EXPECT_TRUE(std::isnan(followed.record.animation_residual));
}

}  // namespace
}  // namespace lacuna
