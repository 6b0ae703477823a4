// The noise of markers, estimated from their recording.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "prediction/recording_noise.h"

namespace lacuna {
namespace {

// Markers that move at a constant velocity, so that their second differences over time are noise
// alone. One of them is missing in every third frame and therefore has no second difference.
TEST(MarkerNoise, IsThatOfACoordinateUnderASteadyMotion) {
  constexpr double kNoise = 2e-4;  // m
  PredictedRecording item;
  item.recording.markers.places = Eigen::Matrix3Xd::Random(3, 20);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, kNoise);
  std::vector<int> frames;
  for (int frame = 0; frame < 200; ++frame) {
    Eigen::Matrix3Xd positions = item.recording.markers.places.array() + 0.01 * frame;
    for (double& coordinate : positions.reshaped()) coordinate += noise(random);
    if (frame % 3 == 0) positions.col(4).setConstant(std::nan(""));
    item.recording.markers.positions.push_back(positions);
    item.recording.times.push_back(0.01 * frame);
    frames.push_back(frame);
  }
  // The median over the 57 coordinates of 19 markers, each from the median of 198 differences, has
  // a standard deviation of about 1.7 % of the noise.
  EXPECT_NEAR(EstimateRecordingNoise(item, frames), kNoise, 0.05 * kNoise);
  // Two frames have no second difference.
  EXPECT_EQ(EstimateRecordingNoise(item, {0, 1}), 0);
}

}  // namespace
}  // namespace lacuna
