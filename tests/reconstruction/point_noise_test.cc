#include "reconstruction/point_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.h"

namespace lacuna {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kDeviation = 1e-4;  // m

// Four markers at the corners of a square of 100 mm, which move by `step` (m) from frame to frame.
std::vector<FrameState> NoisyMarkers(int frames, double step) {
  Eigen::Matrix3Xd places(3, 4);
  places << 0, 0.1, 0.1, 0, 0, 0, 0.1, 0.1, 0, 0, 0, 0;
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, kDeviation);
  std::vector<FrameState> states(static_cast<size_t>(frames));
  for (int k = 0; k < frames; ++k) {
    FrameState& state = states[static_cast<size_t>(k)];
    state.time = 0.1 * k;
    state.tracked = places.array() + step * k;
    for (double& coordinate : state.tracked.reshaped()) coordinate += normal(random);
    state.cloud.points = state.tracked;
  }
  return states;
}

// 330 degrees of freedom determine the deviation to 4 %. The size of the square times 1e-5, which
// planes through neighbours give for so few points, is a seventieth of it.
TEST(PointNoise, OfMarkersAtRestIsTheirScatter) {
  const PointNoise noise = EstimatePointNoise(NoisyMarkers(30, 0), true);
  EXPECT_NEAR(noise.deviation, kDeviation, 0.15 * kDeviation);
  EXPECT_EQ(noise.warning, "");
}

// A steady motion has no second differences. Their median determines the deviation less well.
TEST(PointNoise, OfMarkersThatNeverRestIsAnUpperBound) {
  const PointNoise noise = EstimatePointNoise(NoisyMarkers(30, 0.01), true);
  EXPECT_NEAR(noise.deviation, kDeviation, 0.4 * kDeviation);
  EXPECT_THAT(noise.warning, HasSubstr("is an upper bound"));
}

// A flat square, scanned 1 mm above the surface that was reconstructed from it.
TEST(PointNoise, ContainsTheErrorOfAReconstructedShape) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, kDeviation);
  std::vector<FrameState> states(1);
  Eigen::Matrix3Xd& points = states[0].cloud.points;
  points.resize(3, 400);
  for (int i = 0; i < 400; ++i) points.col(i) << 0.005 * (i % 20), 0.005 * (i / 20), normal(random);
  TriMesh shape;
  shape.vertices.resize(3, 4);
  shape.vertices << -1, 1, 1, -1, -1, -1, 1, 1, -0.001, -0.001, -0.001, -0.001;
  shape.triangles.resize(3, 2);
  shape.triangles << 0, 0, 1, 2, 2, 3;
  const PointNoise alone = EstimatePointNoise(states, false);
  EXPECT_NEAR(alone.deviation, kDeviation, 0.2 * kDeviation);
  EXPECT_EQ(alone.warning, "");
  const PointNoise with = EstimatePointNoise(states, false, shape);
  const double distance = std::hypot(0.001, kDeviation);
  EXPECT_NEAR(with.deviation, std::hypot(distance, kDeviation), 0.05 * distance);
  EXPECT_THAT(with.warning, HasSubstr("misses its own points"));
}

TEST(PointNoise, IsRefusedWhereThePointsDoNotShowIt) {
  EXPECT_THAT([] { EstimatePointNoise(NoisyMarkers(2, 0), true); },
              ThrowsMessage<InputError>(HasSubstr("fit.noise must be given")));
  EXPECT_THAT([] { EstimatePointNoise(NoisyMarkers(30, 0), false); },
              ThrowsMessage<InputError>(HasSubstr("has 4; at least 17 are needed")));
}

}  // namespace
}  // namespace lacuna
