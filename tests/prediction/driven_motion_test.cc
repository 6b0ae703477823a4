#include "prediction/driven_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace lacuna {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const Eigen::VectorXd kPath = 1e-3 * Eigen::VectorXd::LinSpaced(6, 0, 5);

std::string MistakeIn(const Eigen::MatrixXd& object) { return MistakeInPath({kPath, object}); }

TEST(MistakeInPath, IsNoneWhereSomethingFollows) {
  EXPECT_EQ(MistakeIn(0.4 * kPath), "");
  EXPECT_EQ(MistakeIn(3 * kPath), "") << "a lever";
  Eigen::MatrixXd ends(6, 2);
  ends << -0.2 * kPath, 0.95 * kPath;
  EXPECT_EQ(MistakeIn(ends), "") << "one end bulges";
}

TEST(MistakeInPath, IsNoneWhereTheMotionIsAnother) {
  Eigen::VectorXd noise(6);
  noise << 0, 1, -1, 1, -1, 1;
  EXPECT_EQ(MistakeIn(-1e-3 * noise), "");
  EXPECT_EQ(MistakeIn(Eigen::VectorXd::Zero(6)), "");
}

TEST(MistakeInPath, NamesTheSign) {
  Eigen::VectorXd moved = -0.5 * kPath;
  moved[2] = std::numeric_limits<double>::quiet_NaN();  // not seen
  EXPECT_THAT(MistakeIn(moved), HasSubstr("opposite direction"));
  Eigen::MatrixXd ends(6, 2);
  ends << Eigen::VectorXd::Zero(6), -0.9 * kPath;
  EXPECT_THAT(MistakeIn(ends), HasSubstr("opposite direction"));
}

TEST(MistakeInPath, NamesTheUnit) {
  EXPECT_THAT(MistakeIn(800 * kPath), HasSubstr("8e+02 times as far: is `length_unit`"));
  EXPECT_THAT(MistakeIn(-0.0009 * kPath), HasSubstr("0.0009 times as far: is `length_unit`"));
}

// Points of a bar between a support and a jaw, which moves along `path` (m, one place a frame);
// they move by a half of `moved`.
PredictedRecording PulledPoints(const std::vector<double>& path, const std::vector<double>& moved) {
  PredictedRecording item;
  item.name = "pull";
  PointFrames points;
  points.tracked = true;
  item.recording.frames = points;
  RecordedGrip jaw;
  jaw.region.name = "jaw";
  jaw.motion = GripMotion::kGiven;
  jaw.times.resize(static_cast<Eigen::Index>(path.size()));
  jaw.displacements = Eigen::Matrix3Xd::Zero(3, jaw.times.size());
  for (size_t k = 0; k < path.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    item.frames.push_back(static_cast<int>(k));
    item.recording.times.push_back(0.2 * static_cast<double>(k));
    jaw.times[column] = item.recording.times[k];
    jaw.displacements(0, column) = path[k];
    Eigen::Matrix3Xd places = 0.01 * Eigen::Matrix3Xd::Identity(3, 3);
    places.row(0).array() += 0.5 * moved[k];
    places.row(1).array() += 1e-5 * static_cast<double>(k % 3);
    item.recording.markers.positions.push_back(places);
  }
  item.recording.object.grips = {jaw};
  return item;
}

TEST(DoubtOfIncrements, IsRaisedByPointsThatFollowTheStepsOfThePath) {
  const std::vector<double> path{0, 0, 0, 1e-3, 2e-3, 3e-3, 4e-3};
  EXPECT_EQ(DoubtOfIncrements(PulledPoints(path, path)), "");
  // A body that yields more and more.
  EXPECT_EQ(DoubtOfIncrements(PulledPoints(path, {0, 0, 0, 0.5e-3, 1.5e-3, 3e-3, 5e-3})), "");
  const std::vector<double> steps{0, 0, 0, 1e-3, 1e-3, 1e-3, 1e-3};
  EXPECT_THAT(DoubtOfIncrements(PulledPoints(path, steps)),
              AllOf(HasSubstr("pull: "), HasSubstr("the steps of \"jaw\"")));
  PredictedRecording untracked = PulledPoints(path, steps);
  untracked.recording.frames = PointFrames();
  EXPECT_EQ(DoubtOfIncrements(untracked), "");
  EXPECT_EQ(DoubtOfIncrements(PulledPoints({0, 0, 0, 0, 0, 0, 0}, steps)), "");
}

TEST(DoubtOfPaths, IsRaisedOfSlowMotionsThatGoTheOtherWay) {
  const std::vector<double> path{0, 0, 0, 1e-3, 2e-3, 3e-3, 4e-3};
  std::vector<double> back;
  for (const double place : path) back.push_back(-place);
  PredictionStudy study;
  study.scheme = TimeScheme::kQuasiStatic;
  EXPECT_EQ(DoubtOfPaths(study, PulledPoints(path, path)), "");
  EXPECT_THAT(DoubtOfPaths(study, PulledPoints(path, back)),
              AllOf(HasSubstr("pull: while \"jaw\" moves"), HasSubstr("opposite direction")));
  PredictedRecording turns = PulledPoints(path, back);
  turns.recording.object.grips[0].rotations = Eigen::Matrix3Xd::Zero(3, 7);
  EXPECT_EQ(DoubtOfPaths(study, turns), "");
  study.scheme = TimeScheme::kTwoStep;
  EXPECT_EQ(DoubtOfPaths(study, PulledPoints(path, back)), "") << "it may swing";
}

}  // namespace
}  // namespace lacuna
