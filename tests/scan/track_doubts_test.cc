#include "scan/track_doubts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lacuna {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kSwingFrames = 60;

// Six markers along a bar that rests for 20 frames and then swings, by 20 mm at its tip; seen with
// a noise of 0.02 mm.
MarkerTracks SwingingTracks() {
  MarkerTracks tracks;
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 2e-5);
  for (int m = 0; m < 6; ++m) tracks.names.push_back("m" + std::to_string(m));
  for (int f = 0; f < kSwingFrames; ++f) {
    const double phase = f < 20 ? 0 : std::sin(0.2 * (f - 20));
    Eigen::Matrix3Xd places(3, 6);
    for (int m = 0; m < 6; ++m)
      places.col(m) << 0.014 * m, 0.02 * phase * std::pow(m / 5.0, 2), m % 2 == 0 ? 0.01 : -0.01;
    for (double& coordinate : places.reshaped()) coordinate += noise(random);
    tracks.positions.push_back(places);
  }
  return tracks;
}

std::vector<std::string> DoubtsAbout(const MarkerTracks& tracks) {
  return DoubtsOfTracks(tracks, "m.csv");
}

TEST(TrackDoubts, AreNotRaisedByMotionNoiseAndGaps) {
  MarkerTracks tracks = SwingingTracks();
  EXPECT_THAT(DoubtsAbout(tracks), IsEmpty());
  for (int f = 10; f < 15; ++f) tracks.positions[f].col(2).setConstant(std::nan(""));
  EXPECT_THAT(DoubtsAbout(tracks), IsEmpty());
  // Rounded to 0.1 mm, most coordinates repeat while the bar rests.
  for (Eigen::Matrix3Xd& positions : tracks.positions)
    positions = 1e-4 * (1e4 * positions).array().round().matrix();
  EXPECT_THAT(DoubtsAbout(tracks), IsEmpty());
  // Without noise, and a marker that is glued to the clamp.
  for (Eigen::Matrix3Xd& positions : tracks.positions) {
    positions.col(0).setZero();
    positions = 1e-3 * (1e3 * positions).array().round().matrix();
  }
  EXPECT_THAT(DoubtsAbout(tracks), IsEmpty());
}

TEST(TrackDoubts, NameExchangedMarkers) {
  MarkerTracks tracks = SwingingTracks();
  for (int f = 30; f < 33; ++f) tracks.positions[f].col(3).swap(tracks.positions[f].col(4));
  EXPECT_THAT(DoubtsAbout(tracks),
              ElementsAre(HasSubstr("exchanged, m3 and m4 in frame 30, m3 and m4 in frame 33: ")));
  // After a gap in both tracks.
  tracks = SwingingTracks();
  for (int f = 8; f < 12; ++f) tracks.positions[f].middleCols(1, 2).setConstant(std::nan(""));
  for (int f = 12; f < kSwingFrames; ++f)
    tracks.positions[f].col(1).swap(tracks.positions[f].col(2));
  EXPECT_THAT(DoubtsAbout(tracks), ElementsAre(HasSubstr("m1 and m2 in frame 12: ")));
}

TEST(TrackDoubts, NameMarkersThatJump) {
  MarkerTracks tracks = SwingingTracks();
  for (int f = 30; f < 33; ++f) tracks.positions[f](2, 3) += 0.03;
  tracks.positions[40].col(1).setConstant(-9.999);
  EXPECT_THAT(DoubtsAbout(tracks),
              ElementsAre(HasSubstr("jump, m1 by 1.73e+04 mm in frame 40, m3 by 30")));
  // One that moves alone, because the others are at rest, may do so.
  tracks = SwingingTracks();
  for (int f = 0; f < kSwingFrames; ++f) {
    tracks.positions[f].leftCols(5) = tracks.positions[0].leftCols(5);
    tracks.positions[f](2, 5) = f < 30 ? 0.01 : 0.04;
  }
  EXPECT_THAT(DoubtsAbout(tracks), IsEmpty());
}

TEST(TrackDoubts, NameMarkersWhoseCoordinatesRepeat) {
  MarkerTracks tracks = SwingingTracks();
  for (int f = 31; f < 36; ++f) tracks.positions[f].col(5) = tracks.positions[30].col(5);
  EXPECT_THAT(DoubtsAbout(tracks),
              testing::Contains(HasSubstr("repeat their coordinates exactly, m5 in frames 30 to "
                                          "35: ")));
  // A camera that delivers a frame several times repeats all of them.
  tracks = SwingingTracks();
  for (int f = 31; f < 36; ++f) tracks.positions[f] = tracks.positions[30];
  EXPECT_THAT(DoubtsAbout(tracks), IsEmpty());
}

}  // namespace
}  // namespace lacuna
