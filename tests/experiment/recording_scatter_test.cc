#include "experiment/recording_scatter.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

#include "experiment/scatter_findings.h"
#include "support/marker_recording.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double kRadius = 50;  // mm, of a scanned sphere; its points have a spacing of 3.2 mm

class RecordingScatterTest : public testing::Test {
 protected:
  // Five scans of a sphere with 3000 points that scatter by `noise` (mm). In frame 2, each
  // `every`-th point lies 5 mm off; 0: none.
  Recording Scans(double noise, int every = 0) {
    for (int f = 0; f < 5; ++f) {
      std::ofstream table(folder_ / fmt::format("scan_{}.csv", f));
      table << "x,y,z\n";
      for (int i = 0; i < 3000; ++i) {
        Eigen::Vector3d point(normal_(random_), normal_(random_), normal_(random_));
        const bool is_off = every > 0 && f == 2 && i % every == 0;
        point *= (kRadius + noise * normal_(random_) + (is_off ? 5 : 0)) / point.norm();
        table << fmt::format("{},{},{}\n", point.x(), point.y(), point.z());
      }
    }
    return Load("mm", "frames: {kind: points, pattern: scan_%d.csv, count: 5, rate: 10 Hz}\n");
  }

  // 120 frames of `count` markers that swing by 20 mm, with this noise (mm).
  Recording Swing(double noise, int count = 6) {
    std::ofstream table(folder_ / "markers.csv");
    Eigen::Matrix3Xd places(3, count);
    table << "t";
    for (int m = 0; m < count; ++m) {
      places.col(m) << 0.01 * m, 0, 0;
      table << fmt::format(",m{0}_x,m{0}_y,m{0}_z", m);
    }
    for (int f = 0; f < 120; ++f) {
      table << fmt::format("\n{}", 0.01 * f);
      for (int m = 0; m < count; ++m)
        for (int axis = 0; axis < 3; ++axis)
          table << fmt::format(",{:.9f}", places(axis, m) + 0.02 * std::sin(0.1 * f + m) +
                                              1e-3 * noise * normal_(random_));
    }
    table << "\n";
    table.close();
    WriteBoxSurface(folder_ / "box.off", {0, 0, 0}, {0.05, 0.01, 0.01});
    return Load("m", "reference: {from: mesh, file: box.off}\n" + MarkerFrames(places));
  }

  Recording Load(const std::string& unit, const std::string& rest) const {
    std::ofstream(folder_ / "recording.yaml")
        << "schema_version: 1\nname: body\nlength_unit: " << unit << "\n"
        << rest;
    return LoadRecording(folder_ / "recording.yaml");
  }

  static RecordingScatter Measure(const Recording& recording) {
    ScatterSurvey survey(recording);
    for (int f = 0; f < recording.FrameCount(); ++f) survey.Add(LoadFrame(recording, f));
    return survey.Result();
  }

  TemporaryFolder folder_;
  std::mt19937 random_{3};
  std::normal_distribution<double> normal_;
};

TEST_F(RecordingScatterTest, OfScansIsTheMedianOverTheFrames) {
  const RecordingScatter scatter = Measure(Scans(0.3));
  EXPECT_TRUE(scatter.is_of_surface);
  // Two thousand points of a frame determine it to 3 %, the choice of the smaller estimate and the
  // shape of the sphere change it by as much.
  EXPECT_NEAR(scatter.typical, 3e-4, 3.5e-5);
  EXPECT_NEAR(scatter.largest, 3e-4, 4.5e-5);  // of a single frame
  EXPECT_THAT(scatter.largest_in, HasSubstr("frame "));
  EXPECT_FALSE(scatter.is_upper_bound);
  EXPECT_NEAR(scatter.spacing, 3.24e-3, 0.3e-3);  // √(4π R²/3000)
}

TEST_F(RecordingScatterTest, ASoundRecordingRaisesNoDoubt) {
  const Recording scans = Scans(0.3);
  const ExaminedRecording examined = ExamineRecording(scans, {0.3e-3, "scan.noise"});
  EXPECT_THAT(examined.findings, IsEmpty());
  EXPECT_THAT(examined.scatter, AllOf(HasSubstr("the points scatter by 0."), HasSubstr("in frame"),
                                      HasSubstr("their spacing is 3.")));
  // Without an experiment, no noise is stated.
  EXPECT_THAT(ExamineRecording(scans).findings, IsEmpty());
  const ExaminedRecording swing = ExamineRecording(Swing(0.1), {0.1e-3, "noise"});
  EXPECT_THAT(swing.findings, IsEmpty());
  EXPECT_THAT(swing.scatter, HasSubstr("each coordinate about their motion"));
}

TEST_F(RecordingScatterTest, NoiseThatIsStatedTooSmallIsDoubtedAndALargeOneNoted) {
  const Recording scans = Scans(0.3);
  EXPECT_THAT(
      ExamineRecording(scans, {0.05e-3, "scan.noise"}).findings,
      ElementsAre(AllOf(HasSubstr("times the stated `scan: {noise: 0.05 mm}`"),
                        HasSubstr("Write `scan: {noise: 0."), HasSubstr("or omit the key"))));
  const ExaminedRecording noted = ExamineRecording(scans, {2e-3, "fit.noise"});
  EXPECT_THAT(noted.findings, IsEmpty());
  EXPECT_THAT(noted.scatter, AllOf(HasSubstr("the points scatter by 0."),
                                   HasSubstr("the stated `fit: {noise: 2 mm}` is")));
  EXPECT_THAT(ExamineRecording(scans, {0.3e-3, "fit.noise"}).scatter, Not(HasSubstr("the stated")));
  // Markers that never rest may vibrate.
  EXPECT_THAT(ExamineRecording(Swing(0.1), {0.01e-3, "noise"}).findings, IsEmpty());
}

TEST_F(RecordingScatterTest, ScatterThatExceedsHalfOfTheSpacingIsReported) {
  const Recording scans = Scans(2.5);
  EXPECT_THAT(ExamineRecording(scans).findings,
              ElementsAre(AllOf(HasSubstr("more than half of their spacing of 3."),
                                HasSubstr("cannot be meshed reliably"))));
  // A cube of 10 mm contains some nine points, whose mean scatters by 0.8 mm.
  EXPECT_THAT(ExamineRecording(scans, {0, "scan.noise", 10e-3}).findings, IsEmpty());
}

TEST_F(RecordingScatterTest, OutliersAreReportedWithTheirFrame) {
  const Recording scans = Scans(0.3, 25);
  const RecordingScatter scatter = Measure(scans);
  EXPECT_EQ(scatter.worst_frame, 2);
  // 4 %; two thousand examined points determine it to 0.4 %, and some beside others are missed.
  EXPECT_GT(scatter.worst_share, 0.025);
  EXPECT_LT(scatter.worst_share, 0.05);
  EXPECT_THAT(
      ExamineRecording(scans).findings,
      ElementsAre(AllOf(HasSubstr("of the points are outliers"), HasSubstr("most in frame 2"))));
}

TEST_F(RecordingScatterTest, OfMarkersIsThatOfACoordinate) {
  const RecordingScatter scatter = Measure(Swing(0.1));
  EXPECT_FALSE(scatter.is_of_surface);
  // 18 coordinates of 120 frames determine it to some 6 %, and the motion adds a few per cent.
  EXPECT_NEAR(scatter.typical, 1e-4, 2e-5);
  EXPECT_TRUE(scatter.is_upper_bound);
  EXPECT_EQ(scatter.outlier_share, 0);
  EXPECT_THAT(scatter.largest_in, HasSubstr("marker m"));
}

TEST_F(RecordingScatterTest, TheDeviationOfAMarkerThatLeavesItsTrackIsReported) {
  Recording recording = Swing(0.1);
  recording.markers.positions[60](0, 0) += 20e-3;
  // The noise of the difference from the cubic has the deviation √70/6 σ = 0.14 mm.
  EXPECT_NEAR(Measure(recording).farthest, 20e-3, 1e-3);
  EXPECT_THAT(ExamineRecording(recording).scatter,
              AllOf(HasSubstr("leave their track for a frame, by up to "),
                    HasSubstr(" mm in a coordinate, most in frame 60, 17 % of the tracks")));
}

TEST_F(RecordingScatterTest, OfThreeMarkersNoneIsCalledAnOutlier) {
  const Recording recording = Swing(0.1, 3);
  EXPECT_TRUE(std::isnan(Measure(recording).outlier_share));
  const ExaminedRecording examined = ExamineRecording(recording);
  EXPECT_THAT(examined.findings, IsEmpty());
  EXPECT_THAT(examined.scatter,
              AllOf(HasSubstr("the points scatter"), Not(HasSubstr("leave their track"))));
}

// In frames without any marker the body moves on.
TEST_F(RecordingScatterTest, AGapOfAllMarkersIsNoJump) {
  Recording recording = Swing(0.02);
  // One marker moves steadily and fast; it would jump by 1 m if the frames beside the gap counted
  // as consecutive.
  for (int f = 0; f < 120; ++f) recording.markers.positions[f](0, 0) += 0.1 * f;
  for (int f = 50; f < 60; ++f)
    recording.markers.positions[f].setConstant(std::numeric_limits<double>::quiet_NaN());
  const RecordingScatter scatter = ScatterSurvey(recording).Result();
  EXPECT_EQ(scatter.outlier_share, 0);
  // 18 coordinates of 110 frames determine it to some 6 %, and the motion adds a few per cent.
  EXPECT_NEAR(scatter.typical, 2e-5, 5e-6);
  // Every second frame is all that an experiment uses.
  for (int f = 1; f < 120; f += 2)
    recording.markers.positions[f].setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_GT(ScatterSurvey(recording).Result().typical, 0);
}

// Weights are inverse variances: the marker of a sixteenth has four times the noise.
TEST_F(RecordingScatterTest, OfWeightedMarkersIsInTrueMillimetres) {
  Recording recording = Swing(0);
  for (Eigen::Matrix3Xd& places : recording.markers.positions)
    for (int m = 0; m < 6; ++m)
      for (int axis = 0; axis < 3; ++axis)
        places(axis, m) += 1e-5 * (m == 4 ? 4 : 1) * normal_(random_);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(6);
  weights[4] = 1.0 / 16;
  recording.markers.weights.assign(recording.times.size(), weights);
  const RecordingScatter scatter = ScatterSurvey(recording).Result();
  EXPECT_NEAR(scatter.typical, 1e-5, 2e-6);  // as above
  EXPECT_EQ(scatter.largest_in, "marker m4");
  EXPECT_NEAR(scatter.largest, 4e-5, 1.6e-5);  // three coordinates determine it to some 15 %
  EXPECT_EQ(scatter.outlier_share, 0);         // judged by its own noise
}

// A marker that moves slowly while the others move fast stays within a threshold of its own.
TEST_F(RecordingScatterTest, OfMarkersIsThatOfFramesInWhichAllRest) {
  Recording recording = Swing(0);
  for (int f = 0; f < 120; ++f)
    for (int m = 0; m < 6; ++m)
      for (int axis = 0; axis < 3; ++axis) {
        const double swing = f < 40 ? 0 : std::sin(0.4 * (f - 40));
        recording.markers.positions[f](axis, m) = recording.markers.places(axis, m) +
                                                  (m == 5 ? 2e-4 : 0.02) * swing +
                                                  1e-4 * normal_(random_);
      }
  const RecordingScatter scatter = ScatterSurvey(recording).Result();
  EXPECT_FALSE(scatter.is_upper_bound);
  // Of three coordinates in some 35 frames, which determine each to 10 %; the largest of six is
  // above the mean. With its motion, m5 scatters by 0.15 mm.
  EXPECT_NEAR(scatter.typical, 1e-4, 1.5e-5);
  EXPECT_LT(scatter.largest, 1.35e-4);
}

TEST_F(RecordingScatterTest, OfTrackedPointsIsThatOverTime) {
  // 60 points of a sheet at rest in 30 frames. In space they are as rough as the sheet is.
  for (int f = 0; f < 30; ++f) {
    std::ofstream table(folder_ / fmt::format("points_{}.csv", f));
    table << "x,y,z\n";
    for (int i = 0; i < 60; ++i)
      table << fmt::format("{},{},{}\n", 5 * (i % 10) + 0.02 * normal_(random_),
                           5 * (i / 10) + 0.02 * normal_(random_),
                           i * 37 % 5 + 0.02 * normal_(random_));
  }
  const RecordingScatter scatter = Measure(Load(
      "mm",
      "frames: {kind: points, pattern: points_%d.csv, count: 30, rate: 1 Hz, tracked: true}\n"));
  EXPECT_FALSE(scatter.is_of_surface);
  EXPECT_FALSE(scatter.is_upper_bound);
  EXPECT_NEAR(scatter.typical, 2e-5, 2e-6);  // 5400 values determine it to 1 %
}

}  // namespace
}  // namespace lacuna
