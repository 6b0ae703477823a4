// Reconstructions of markers: points that identify themselves, some of which move the model.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "experiment/reference_body.h"
#include "geometry/mesh_io.h"
#include "reconstruction/body_registration.h"
#include "reconstruction/follow.h"
#include "reconstruction/reconstruction_measures.h"
#include "reconstruction/recorded_states.h"
#include "reconstruction/residual_at_vertices.h"
#include "reconstruction/shown_reconstruction.h"
#include "support/box_mesh.h"
#include "support/marker_recording.h"
#include "support/replace_in_file.h"
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

}  // namespace
}  // namespace lacuna
