// How a model follows markers: grips, forces, starts, and what is refused or reported.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/error.h"
#include "reconstruction/body_registration.h"
#include "reconstruction/followed_markers.h"
#include "support/replace_in_file.h"

namespace lacuna {
namespace {

using testing::Contains;
using testing::HasSubstr;

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

// In frame 1, the first that is followed, the marker at the tip has moved already.
TEST(MarkerMotion, ForcesOfARecordingThatBeginsDeformedDoNotDependOnItsFirstFrame) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 6, {0, 0, 0.001}, [](int m) { return m >= 4; }, kClamped);
  const auto force = [&](const std::string& more) {
    const FollowedMarkers followed = Follow(folder, "fit: {noise: 0.1 mm}\n" + more, kTipForce);
    EXPECT_TRUE(followed.motion.frames.back().solver.usable);
    return followed.motion.frames.back().force.row(2).sum();
  };
  const double from_rest = force("");
  EXPECT_GT(from_rest, 0);
  EXPECT_NEAR(force("frames: {first: 1}\n"), from_rest, 0.01 * from_rest) << "of the search";
}

TEST(MarkerMotion, AMarkerThatTheFirstFrameDoesNotShowIsUsedInTheOthers) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 6, {0, 0, 0.001}, [](int m) { return m >= 4; }, kClamped, /*hidden=*/2);
  const FollowedMarkers followed = Follow(folder, "fit: {noise: 0.1 mm}\n", kTipForce);
  ASSERT_EQ(followed.motion.frames.size(), 3u);
  EXPECT_EQ(followed.motion.frames[0].observations, 5);
  EXPECT_EQ(followed.motion.frames[1].observations, 6);
  EXPECT_TRUE(followed.motion.frames[2].residual.allFinite());
  EXPECT_THAT(followed.motion.warnings, testing::Not(Contains(HasSubstr("used in no frame"))));
}

TEST(MarkerMotion, AMarkerWithoutAPlaceThatTheFirstFrameDoesNotShowIsReported) {
  const TemporaryFolder folder;
  constexpr int kHidden = 2;
  WriteMarkers(
      folder, 6, {0, 0, 0.001}, [](int m) { return m >= 4; }, kClamped, kHidden);
  ReplaceInFile(folder / "recording.yaml", "    - {name: m2,", "    # - {name: m2,");
  const FollowedMarkers followed = Follow(folder, "fit: {noise: 0.1 mm}\n", kTipForce);
  EXPECT_THAT(followed.motion.warnings,
              Contains(HasSubstr("1 of 6 tracked points are used in no frame")));
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

// Twelve points are too few for CPD to register them without a warning.
TEST(MarkerMotion, TheStartOfAFrameFollowsIdentifiedPoints) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 12, {0, 0, 0.002}, [](int) { return true; }, kClamped);
  FollowedMarkers followed = Follow(folder, "");
  EXPECT_THAT(followed.record.warnings, testing::Not(Contains(HasSubstr("registration"))));
  const Eigen::Isometry3d turn = Eigen::Translation3d(0.04, 0, 0) *
                                 Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()) *
                                 Eigen::Translation3d(-0.04, 0, 0);
  followed.states[1].tracked = turn * followed.states[0].tracked;
  BodyRegistration registration(followed.study, *followed.motion.body, followed.states, nullptr,
                                &followed.motion.warnings);
  const Eigen::Matrix3Xd& rest = followed.motion.body->mesh.nodes;
  EXPECT_LT((registration.Shift(1, rest) - (turn * rest - rest)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT(registration.Shift(0, rest).cwiseAbs().maxCoeff(), 1e-9) << "the undeformed body";
  // Where one marker moves by itself, what is near it moves with it.
  followed.states[1].tracked = followed.states[0].tracked;
  followed.states[1].tracked(1, 11) += 1e-3;
  const Eigen::Vector3d there = followed.states[0].tracked.col(11);
  EXPECT_NEAR(registration.Shift(1, there)(1, 0), 1e-3, 1e-5);
  const Eigen::Vector3d far = followed.states[0].tracked.col(0);
  EXPECT_NEAR(registration.Shift(1, far)(1, 0), 0, 1e-5);
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

TEST(MarkerMotion, KeysWithoutEffectAreAWarning) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 4, {0, 0, 0.002}, [](int) { return true; }, kClamped);
  const auto warnings = [&](const std::string& more, const std::string& forces) {
    return Follow(folder, more, forces).study.recording.warnings;
  };
  const std::vector<std::string> ignored =
      warnings("fit: {noise: 0.1 mm, reach: 0.2}\n", "{model: none, length: 10 mm}");
  EXPECT_THAT(ignored, Contains(HasSubstr("forces.length has no effect with forces.model none")));
  EXPECT_THAT(ignored, Contains(HasSubstr("fit.reach has no effect on markers")));
  EXPECT_THAT(warnings("fit: {noise: 0.1 mm}\n", kTipForce),
              testing::Not(Contains(HasSubstr("has no effect"))));
}

TEST(MarkerMotion, AHoldOutThatSelectsNoMarkerIsRefused) {
  const TemporaryFolder folder;
  WriteMarkers(
      folder, 4, {0, 0, 0.002}, [](int) { return true; }, kClamped);
  EXPECT_THAT([&] { Follow(folder, "validation: {hold_out_every: 100}\n"); },
              testing::ThrowsMessage<InputError>(
                  HasSubstr("hold_out_every: holds out none of the 4 tracked points")));
}

}  // namespace
}  // namespace lacuna
