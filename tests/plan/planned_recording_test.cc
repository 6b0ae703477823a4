#include "plan/planned_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "core/error.h"
#include "plan/planned_bar.h"
#include "scan/measured_force.h"
#include "scan/recorded_grip.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

constexpr double kLastFrame = 0.01 * (kFrames - 1), kRowSpacing = 0.1 * kLastFrame;  // s

// A clamp that moves at a steady velocity (m/s) along a path from 0 to `end` (s).
RecordedGrip SteadyClamp(const Eigen::Vector3d& velocity, double end) {
  RecordedGrip grip;
  grip.region = {"clamp", HalfSpaceRegion{{0.002, 0, 0}, -Eigen::Vector3d::UnitX()}};
  grip.motion = GripMotion::kGiven;
  grip.times = Eigen::VectorXd::LinSpaced(11, 0, end);
  grip.displacements = velocity * grip.times.transpose();
  return grip;
}

class PlannedRecordingOfABar : public ::testing::Test {
 protected:
  Protocol Named(const std::string& name) const {
    Protocol protocol;
    protocol.name = name;
    protocol.recording = bar_.Name();
    return protocol;
  }
  PlannedRecording Plan(const Protocol& protocol) const {
    return PlanRecording(protocol, bar_.study, bar_.mesh);
  }
  std::string ErrorOf(const Protocol& protocol) const {
    try {
      Plan(protocol);
    } catch (const InputError& problem) {
      return problem.what();
    }
    return "";
  }

  PlannedBar bar_;
};

TEST_F(PlannedRecordingOfABar, FitsAllFramesOfARepetition) {
  const PlannedRecording planned = Plan(Named("again"));
  EXPECT_EQ(planned.item.name, "again");
  EXPECT_EQ(planned.item.frames.size(), static_cast<size_t>(kFrames));
  EXPECT_TRUE(std::isinf(planned.item.fit_until));
  EXPECT_NEAR(planned.Seconds(), 0.01 * (kFrames - 1), 1e-12);
  EXPECT_TRUE(planned.fixture.isApprox(Eigen::Isometry3d::Identity()));
}

TEST_F(PlannedRecordingOfABar, LastsLongerWithTheSameSpacing) {
  Protocol protocol = Named("longer");
  protocol.duration = 2;
  const PlannedRecording planned = Plan(protocol);
  const std::vector<double>& times = planned.item.recording.times;
  const double last = 0.01 * (kFrames - 1);
  EXPECT_NEAR(times.back(), kRelease + 2 * (last - kRelease), 0.0051);
  for (size_t k = 1; k < times.size(); ++k) EXPECT_NEAR(times[k] - times[k - 1], 0.01, 1e-9);
  protocol.duration = 0.01;
  EXPECT_EQ(ErrorOf(protocol), "");  // the frames before the release are still there
}

// The clamp moves at a steady velocity until the last frame. Then it comes to rest within a spacing
// of its path, instead of swinging back until the new end.
TEST_F(PlannedRecordingOfABar, RestsInTheLastPoseAndKeepsTheLastForceWhereItLastsLonger) {
  RecordedObject& object = bar_.study.recordings[0].recording.object;
  object.fixed.clear();
  object.grips = {SteadyClamp({0, 0.1, 0}, kLastFrame)};
  MeasuredForce force;
  force.name = "pull";
  force.times = Eigen::Vector2d(0, kLastFrame);
  force.forces = Eigen::Matrix3Xd::Zero(3, 2);
  force.forces(2, 1) = 0.5;
  object.forces = {force};
  Protocol protocol = Named("longer");
  protocol.duration = 2;
  const PlannedRecording planned = Plan(protocol);
  const RecordedObject& made = planned.item.recording.object;
  const double end = planned.item.recording.times.back();
  for (int k = 0; k <= 50; ++k) {
    const double rests = kLastFrame + kRowSpacing, time = rests + k * (end - rests) / 50;
    EXPECT_NEAR(MotionAt(made.grips.at(0), time).translation().y(), 0.1 * kLastFrame, 1e-12)
        << time;
  }
  EXPECT_EQ(made.forces.at(0).times[2], end);
  EXPECT_EQ(ForceAt(made.forces.at(0), end).z(), 0.5);
}

// Its poses are written anew, ten per frame: after one frame more they are all the same.
TEST_F(PlannedRecordingOfABar, RestsInTheLastPoseOnATurnedFixtureToo) {
  RecordedObject& object = bar_.study.recordings[0].recording.object;
  object.fixed.clear();
  object.grips = {SteadyClamp({0, 0.1, 0}, kLastFrame)};
  Protocol protocol = Named("turned and longer");
  protocol.duration = 2;
  protocol.turn = 0.5 * std::numbers::pi * Eigen::Vector3d::UnitY();
  const PlannedRecording planned = Plan(protocol);
  const RecordedGrip& clamp = planned.item.recording.object.grips.at(0);
  const Eigen::Isometry3d expected = planned.fixture * Eigen::Translation3d(0, 0.1 * kLastFrame, 0);
  const double end = planned.item.recording.times.back();
  for (int k = 0; k <= 50; ++k) {
    const double rests = kLastFrame + kRowSpacing + 0.01, time = rests + k * (end - rests) / 50;
    EXPECT_LT((MotionAt(clamp, time).matrix() - expected.matrix()).norm(), 1e-9) << time;
  }
}

// Times of a file are rounded (TimeMargin()). A clamp that moves until the last frame is not to be
// stopped there.
TEST_F(PlannedRecordingOfABar, DoesNotStopAClampWhosePathCoversTheFramesButForRounding) {
  RecordedObject& object = bar_.study.recordings[0].recording.object;
  object.fixed.clear();
  object.grips = {SteadyClamp({0, 0.1, 0}, kLastFrame - 1e-6)};
  const RecordedGrip clamp = Plan(Named("again")).item.recording.object.grips.at(0);
  for (const double before : {0.01, 0.001, 0.0})
    EXPECT_NEAR(MotionAt(clamp, kLastFrame - before).translation().y(), 0.1 * (kLastFrame - before),
                1e-12)
        << before;
}

TEST_F(PlannedRecordingOfABar, TurnsTheClampAndTheHandButNotGravity) {
  Protocol protocol = Named("turned");
  protocol.turn = 0.5 * std::numbers::pi * Eigen::Vector3d::UnitY();
  const PlannedRecording planned = Plan(protocol);
  const RecordedObject& object = planned.item.recording.object;
  EXPECT_TRUE(object.fixed.empty());
  ASSERT_EQ(object.grips.size(), 1u);
  const RecordedGrip& clamp = object.grips[0];
  EXPECT_TRUE(MotionAt(clamp, clamp.times[0]).isApprox(Eigen::Isometry3d::Identity(), 1e-12));
  const double during = planned.item.recording.times[5];
  EXPECT_TRUE(MotionAt(clamp, during).isApprox(planned.fixture, 1e-9));
  // The bar points down: x → −z.
  EXPECT_TRUE((planned.fixture.linear() * Eigen::Vector3d::UnitX())
                  .isApprox(-Eigen::Vector3d::UnitZ(), 1e-9));
  EXPECT_TRUE(PlannedHoldForce(protocol, Eigen::Vector3d(1, 0, 0))
                  .isApprox(-Eigen::Vector3d::UnitZ(), 1e-9));
  protocol.pull = 3;
  EXPECT_NEAR(PlannedHoldForce(protocol, Eigen::Vector3d(1, 0, 0)).norm(), 3, 1e-12);
}

TEST_F(PlannedRecordingOfABar, KnowsTheClampNoBetterWhereItIsMoved) {
  RecordedObject& object = bar_.study.recordings[0].recording.object;
  object.fixed.at(0).placement = {1e-3, 0.02};
  Protocol turned = Named("turned"), shaken = Named("shaken");
  turned.turn = 0.5 * std::numbers::pi * Eigen::Vector3d::UnitY();
  shaken.shake = Protocol::Shake{{0, 0.004, 0}, 5};
  for (const Protocol& protocol : {turned, shaken}) {
    const RecordedGrip clamp = Plan(protocol).item.recording.object.grips.at(0);
    EXPECT_EQ(clamp.placement.shift, 1e-3) << protocol.name;
    EXPECT_EQ(clamp.placement.turn, 0.02) << protocol.name;
  }
}

TEST_F(PlannedRecordingOfABar, ShakesTheClampFromTheReleaseOn) {
  Protocol protocol = Named("shaken");
  protocol.shake = Protocol::Shake{{0, 0.004, 0}, 5};
  const RecordedGrip clamp = Plan(protocol).item.recording.object.grips.at(0);
  EXPECT_LT(MotionAt(clamp, 0.5 * kRelease).translation().norm(), 1e-12);
  // Half a period of sin² after the release, between two poses of the path.
  EXPECT_NEAR(MotionAt(clamp, kRelease + 0.1).translation().y(), 0.004, 2e-5);
  EXPECT_NEAR(MotionAt(clamp, kRelease + 0.05).translation().y(), 0.002, 8e-5);
}

TEST_F(PlannedRecordingOfABar, HasFurtherMarkersFarFromTheOthers) {
  Protocol protocol = Named("markers");
  protocol.more_markers = 6;
  const Markers markers = Plan(protocol).item.recording.markers;
  ASSERT_EQ(markers.names.size(), static_cast<size_t>(kMarkers + 6));
  ASSERT_EQ(markers.places.cols(), kMarkers + 6);
  for (Eigen::Index a = kMarkers; a < markers.places.cols(); ++a) {
    for (Eigen::Index b = 0; b < a; ++b)
      EXPECT_GT((markers.places.col(a) - markers.places.col(b)).norm(), 0.004) << a << " " << b;
    EXPECT_GT(markers.places(0, a), 0.002);  // not in the clamp
  }
  protocol.more_markers = 1000;
  EXPECT_THAT(ErrorOf(protocol), HasSubstr("has room for"));
}

// What is written and fitted are markers: of one noise, at places known to place_deviation.
TEST_F(PlannedRecordingOfABar, IsOneOfMarkersWhereTrackedPointsWereRecorded) {
  Recording& recorded = bar_.study.recordings[0].recording;
  PointFrames tracked;
  tracked.tracked = true;
  recorded.frames = tracked;
  recorded.markers.weights.assign(recorded.times.size(), Eigen::VectorXd::Constant(kMarkers, 2));
  recorded.instrument.subset = 0.002;
  bar_.study.place_deviation_is_given = false;
  const PredictedRecording& item = bar_.study.recordings[0];
  ASSERT_EQ(PlaceDeviation(bar_.study, item, 1e-5), 1e-5);
  const PredictedRecording planned = Plan(Named("again")).item;
  EXPECT_EQ(PlaceDeviation(bar_.study, planned, 1e-5), bar_.study.place_deviation);
  EXPECT_TRUE(planned.recording.markers.weights.empty());
  EXPECT_EQ(planned.recording.instrument.subset, 0.002);
}

// A recording that was made as a plan says has markers with such names already.
TEST_F(PlannedRecordingOfABar, GivesFurtherMarkersNamesThatAreNotTaken) {
  Markers& markers = bar_.study.recordings[0].recording.markers;
  markers.names.at(0) = "new2";
  Protocol protocol = Named("markers");
  protocol.more_markers = 3;
  const std::vector<std::string> names = Plan(protocol).item.recording.markers.names;
  EXPECT_THAT(std::vector<std::string>(names.end() - 3, names.end()),
              ::testing::ElementsAre("new1", "new3", "new4"));
}

TEST_F(PlannedRecordingOfABar, SaysWhatCannotBeDone) {
  Protocol weight = Named("weight");
  weight.weight = Protocol::Weight{0.005, {0.2, 0, 0}, 0.004};
  EXPECT_THAT(ErrorOf(weight), HasSubstr("120 mm away from the object"));
  Protocol other = Named("other");
  other.recording = "nobody";
  EXPECT_THAT(ErrorOf(other), HasSubstr("has no recording \"nobody\""));
  bar_.study.recordings[0].recording.object.fixed.clear();
  Protocol turn = Named("turn");
  turn.turn = Eigen::Vector3d::UnitX();
  EXPECT_THAT(ErrorOf(turn), HasSubstr("turn: nothing holds the object"));
  bar_.study.recordings[0].hold.reset();
  Protocol pull = Named("pull");
  pull.pull = 2;
  EXPECT_THAT(ErrorOf(pull), HasSubstr("nothing pulls"));
}

// A text of the bar's experiment, and what replaces it: the model has a plane of contact at this
// height, too.
std::map<std::string, std::string> TableAt(const std::string& height) {
  const std::string damping = "  - {type: mass_damping, alpha: 1 1/s}\n";
  const std::string contact = "  - {type: plane_contact, stiffness: 100 MPa/m, offset: ";
  return {{damping, damping + contact + height + "}\n"}};
}

TEST(PlannedRecordingAboveATable, DoesNotMoveTheClampThroughIt) {
  const PlannedBar bar(TableAt("-12 mm"));  // 2 mm below the bar
  Protocol protocol;
  protocol.name = "shaken";
  protocol.recording = bar.Name();
  protocol.shake = Protocol::Shake{{0, 0, 0.004}, 5};
  EXPECT_NO_THROW(PlanRecording(protocol, bar.study, bar.mesh));
  protocol.shake->amplitude.z() = -0.004;
  try {
    PlanRecording(protocol, bar.study, bar.mesh);
    ADD_FAILURE() << "the clamp moved through the table";
  } catch (const InputError& problem) {
    EXPECT_THAT(problem.what(), HasSubstr("clamp would be"));
    EXPECT_THAT(problem.what(), HasSubstr("mm behind the plane"));
  }
}

// The clamp comes down to 0.5 mm above the table in the last frame that was recorded, and would
// be in the table 0.1 s later if it went on.
TEST(PlannedRecordingAboveATable, LetsTheClampRestAboveItWhereItLastsLonger) {
  PlannedBar bar(TableAt("-12 mm"));
  RecordedObject& object = bar.study.recordings[0].recording.object;
  object.fixed.clear();
  object.grips = {SteadyClamp({0, 0, -0.0015 / kLastFrame}, kLastFrame)};
  Protocol protocol;
  protocol.name = "longer";
  protocol.recording = bar.Name();
  protocol.duration = 2;
  EXPECT_NO_THROW(PlanRecording(protocol, bar.study, bar.mesh));
}

// The lower edge of the clamp lies 1 mm behind the plane that the model has.
TEST(PlannedRecordingAboveATable, LetsTheClampBeAsDeepAsItWasRecorded) {
  const PlannedBar bar(TableAt("-9 mm"));
  Protocol protocol;
  protocol.name = "again";
  protocol.recording = bar.Name();
  EXPECT_NO_THROW(PlanRecording(protocol, bar.study, bar.mesh));
  protocol.shake = Protocol::Shake{{0, 0, 0.004}, 5};
  EXPECT_NO_THROW(PlanRecording(protocol, bar.study, bar.mesh));
  protocol.shake->amplitude.z() = -0.004;
  EXPECT_THROW(PlanRecording(protocol, bar.study, bar.mesh), InputError);
}

}  // namespace
}  // namespace lacuna
