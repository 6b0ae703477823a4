#include "experiment/grip_tracks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "calibration/calibration_problem.h"
#include "core/error.h"
#include "effects/catalogue.h"
#include "geometry/rotation.h"
#include "support/held_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();

// A bar that is carried at one end, seen by markers there.
class CarriedByMarkers : public testing::Test {
 protected:
  CarriedByMarkers() : mesh_(BarMesh({4, 1, 1}, 1)) {
    recording_.times = {0, 1, 2};
    recording_.markers.names = {"a", "b", "c", "d"};
    recording_.markers.places.resize(3, 4);
    recording_.markers.places << 0, 0, 0, 0.01, -0.01, 0.01, -0.01, 0.01, 0.01, 0.01, -0.01, 0.01;
  }

  // A grip that follows these markers: in the first frame at rest, in the last where the motion has
  // them, between as `middle` has them.
  void Follow(const std::vector<std::string>& names, const Eigen::Matrix3Xd& middle) {
    RecordedGrip grip;
    grip.region = {"hand", HalfSpaceRegion{{0.002, 0, 0}, {-1, 0, 0}}};
    grip.motion = GripMotion::kFollowsMarkers;
    grip.markers = names;
    grip.deforms = deforms_;
    recording_.object.grips = {grip};
    model_ = {};
    model_.body = std::make_shared<const Body>(MakeBody(mesh_, 1000));
    GripTracks tracks(recording_, mesh_, &model_);
    const Eigen::Matrix3Xd none(3, 0);
    first_lost_ = tracks.Extend(0, none, none, recording_.markers.places) != nullptr;
    const RecordedGrip* lost = tracks.Extend(1, none, none, middle);
    lost_ = lost == nullptr ? "" : lost->region.name;
    tracks.Extend(2, none, none, motion_ * recording_.markers.places);
    const Grip& held = model_.grips.front();
    rest_ = mesh_.nodes(Eigen::all, held.nodes);
    at_middle_ = held.motion(1);
  }

  Eigen::Matrix3Xd Moved() const { return motion_ * recording_.markers.places; }

  TetMesh mesh_;
  Recording recording_;
  Model model_;
  Eigen::Isometry3d motion_ =
      Eigen::Translation3d(0.01, 0.02, -0.01) * Eigen::Isometry3d(RotationBy({0.1, 0.2, -0.1}));
  Eigen::Matrix3Xd rest_, at_middle_;
  std::string lost_;
  bool deforms_ = false;
  bool first_lost_ = true;
};

TEST_F(CarriedByMarkers, MovesAsTheyDo) {
  Follow({"a", "b", "c", "d"}, Moved());
  EXPECT_FALSE(first_lost_);
  EXPECT_EQ(lost_, "");
  EXPECT_LT((at_middle_ - motion_ * rest_).norm(), 1e-12);
}

// A jump of the velocity would be a shock in each frame, the last one included.
TEST_F(CarriedByMarkers, PassesAFrameWithoutAJumpOfItsVelocity) {
  const Eigen::Vector3d shift(0.001, 0.002, -0.001);
  Follow({"a", "b", "c", "d"}, recording_.markers.places.colwise() + shift);
  const auto motion = model_.grips.front().motion;
  constexpr double kLittle = 1e-6;  // s
  for (const double frame : {1.0, 2.0}) {
    const Eigen::Matrix3Xd before = (motion(frame) - motion(frame - kLittle)) / kLittle;
    const Eigen::Matrix3Xd behind = (motion(frame + kLittle) - motion(frame)) / kLittle;
    ASSERT_GT(before.norm(), 0.001);
    EXPECT_LT((behind - before).norm(), 1e-4 * before.norm()) << frame;
  }
}

// A grip that is shifted by 0, 1 and 3 units at 0, 1 and 2 s has the velocities 1, 1.5 and 2 units
// per s there. At 1.5 s it is at 2 − 0.5 / 8 units, and at 2.5 s as far on the other side of 3.
TEST_F(CarriedByMarkers, GoesOnAfterTheLastFrameLikeAGripOnAPathAfterItsLastRow) {
  const Eigen::Vector3d unit(0.001, 0.002, -0.001);
  motion_ = Eigen::Translation3d(3 * unit);
  Follow({"a", "b", "c", "d"}, recording_.markers.places.colwise() + unit);

  Recording on_path;
  on_path.times = recording_.times;
  RecordedGrip grip;
  grip.region = recording_.object.grips.front().region;
  grip.motion = GripMotion::kGiven;
  grip.times = Eigen::Vector3d(0, 1, 2);
  grip.displacements = unit * Eigen::RowVector3d(0, 1, 3);
  on_path.object.grips = {grip};
  Model model;
  model.body = model_.body;
  const GripTracks tracks(on_path, mesh_, &model);

  const std::vector<std::pair<double, double>> expected = {{1.5, 1.9375}, {2, 3}, {2.5, 4.0625},
                                                           {3, 5},        {4, 6}, {9, 6}};
  for (const auto& [time, units] : expected) {
    const Eigen::Matrix3Xd moved = rest_.colwise() + units * unit;
    EXPECT_LT((model_.grips.front().motion(time) - moved).norm(), 1e-12) << time;
    EXPECT_LT((model.grips.front().motion(time) - moved).norm(), 1e-12) << time;
  }
}

TEST_F(CarriedByMarkers, DeformsWithThemWhereItMay) {
  const Eigen::Vector3d stretch(1, 1.2, 0.9);  // the markers lie in the plane x = 0
  const Eigen::Matrix3Xd wide = stretch.asDiagonal() * recording_.markers.places;
  Follow({"a", "b", "c", "d"}, wide);
  const auto inner = [](const Eigen::Matrix3Xd& places) -> Eigen::MatrixXd {
    const Eigen::Matrix3Xd about = places.colwise() - Eigen::Vector3d(places.col(0));
    return about.transpose() * about;
  };
  EXPECT_LT((inner(at_middle_) - inner(rest_)).norm(), 1e-12);  // rigid
  deforms_ = true;
  Follow({"a", "b", "c", "d"}, wide);
  EXPECT_LT((at_middle_ - stretch.asDiagonal() * rest_).norm(), 1e-12);
}

TEST_F(CarriedByMarkers, IsRefusedWhereTwoAreToTellHowItDeforms) {
  deforms_ = true;
  EXPECT_THAT(
      [&] {
        Follow({"a", "b"}, Moved());
      },
      testing::ThrowsMessage<InputError>(testing::HasSubstr("do not span a plane")));
}

TEST_F(CarriedByMarkers, DoesWithoutOneThatIsHidden) {
  Eigen::Matrix3Xd seen = Moved();
  seen(1, 1) = kUnseen;
  Follow({"a", "b", "c", "d"}, seen);
  EXPECT_EQ(lost_, "");
  EXPECT_LT((at_middle_ - motion_ * rest_).norm(), 1e-12);
}

TEST_F(CarriedByMarkers, MovesEvenlyWhereTheyDoNotTell) {
  Eigen::Matrix3Xd seen = Moved();
  seen.leftCols(2).setConstant(kUnseen);
  Follow({"a", "b", "c"}, seen);  // only c, which tells no turn
  EXPECT_EQ(lost_, "hand");
  EXPECT_LT((at_middle_ - 0.5 * (rest_ + motion_ * rest_)).norm(), 1e-12);
}

TEST_F(CarriedByMarkers, DoesNotTurnAboutTheLineOfTwo) {
  Follow({"a", "b"}, recording_.markers.places);
  EXPECT_EQ(lost_, "");
  EXPECT_LT((at_middle_ - rest_).norm(), 1e-12);
}

// A body that is undeformed at some time of the path is carried from there on, about a point that
// is given at its place in the undeformed body.
TEST(RecordedGrips, OnAPathCountFromTheTimeAtWhichTheBodyIsUndeformed) {
  Recording recording;
  recording.times = {0, 1, 2};
  RecordedGrip grip;
  grip.region = {"hand", HalfSpaceRegion{{0.002, 0, 0}, {-1, 0, 0}}};
  grip.motion = GripMotion::kGiven;
  grip.times = Eigen::Vector3d(0, 1, 2);
  grip.displacements.resize(3, 3);
  grip.displacements << 0, 0, 0, 0, 0.01, 0.03, 0, 0, 0;
  grip.rotations = Eigen::Matrix3Xd::Zero(3, 3);
  grip.rotations.row(2) << 0.3, 0.5, 0.6;
  grip.pivot = {0, 0.01, 0};
  recording.object.grips = {grip};
  const TetMesh mesh = BarMesh({4, 1, 1}, 1);
  Model model;
  model.body = std::make_shared<const Body>(MakeBody(mesh, 1000));
  GripTracks tracks(recording, mesh, &model);
  const Grip& held = model.grips.front();
  const Eigen::Matrix3Xd rest = mesh.nodes(Eigen::all, held.nodes);
  EXPECT_LT((held.motion(0) - rest).norm(), 1e-12) << "the first row of the path";
  tracks.Begin(1);
  EXPECT_LT((held.motion(1) - rest).norm(), 1e-12);
  const Eigen::Isometry3d about = Eigen::Translation3d(grip.pivot) *
                                  Eigen::Isometry3d(RotationBy({0, 0, 0.1})) *
                                  Eigen::Translation3d(-grip.pivot);
  const Eigen::Matrix3Xd moved = (about * rest).colwise() + Eigen::Vector3d(0, 0.02, 0);
  EXPECT_LT((held.motion(2) - moved).norm(), 1e-12);
  constexpr double kLittle = 1e-6;  // s
  const Eigen::Matrix3Xd before = (held.motion(2) - held.motion(2 - kLittle)) / kLittle;
  const Eigen::Matrix3Xd behind = (held.motion(2 + kLittle) - held.motion(2)) / kLittle;
  EXPECT_LT((behind - before).norm(), 1e-4 * before.norm()) << "it goes on after its last row";
}

TEST(RecordedGrips, AreRefusedWhereTheLastFrameDoesNotShowThem) {
  const TemporaryFolder folder;
  std::vector<Eigen::Matrix3Xd> markers(kFrames, BarMarkerPlaces());
  for (int frame = 0; frame < kFrames; ++frame) markers[frame].array() += 1e-3 * frame * frame;
  markers.back().leftCols(2).setConstant(kUnseen);
  WriteBarRecording(folder.Path(), markers);
  std::string text = FileContent(folder / "recording.yaml");
  const std::string fixed = "fixed: [{name: clamp, ";
  const size_t at = text.find(fixed);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, fixed.size(), "gripped: [{name: hand, follows_markers: [m0, m1, m2], ");
  std::ofstream(folder / "recording.yaml") << text;
  const PredictionStudy study = ReadBarStudy(folder.Path());
  try {
    const CalibrationProblem problem(study, BarMesh({4, 1, 1}, 1));
    FAIL() << "nothing was refused";
  } catch (const InputError& problem) {
    EXPECT_THAT(problem.what(),
                testing::HasSubstr("frame 25, the last that is used, shows too few of the markers "
                                   "that \"hand\" follows: change `to`"));
  }
}

}  // namespace
}  // namespace lacuna
