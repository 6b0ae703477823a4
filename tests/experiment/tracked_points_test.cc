#include "experiment/tracked_points.h"

#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "analysis/measurement_errors.h"
#include "experiment/observer.h"
#include "prediction/recording_noise.h"
#include "support/held_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// Points of a bar of 80 mm in `frames` tables of VIC-3D. sigma(frame, point) is what the program
// expects; negative: the point failed.
template <typename Sigma, typename Error>
Recording Correlated(const TemporaryFolder& folder, int frames, int points, const Sigma& sigma,
                     const Error& error) {
  for (int f = 0; f < frames; ++f) {
    std::ofstream table(folder / ("f" + std::to_string(f) + ".csv"));
    table << "X,Y,Z,U,V,W,sigma\n";
    for (int i = 0; i < points; ++i)
      table << 80.0 * i / points << "," << i % 7 - 3 << "," << i % 3 << "," << error(f, i) << ","
            << error(f, i) << "," << error(f, i) << "," << sigma(f, i) << "\n";
  }
  std::ofstream(folder / "recording.yaml") << "schema_version: 1\nname: bar\nlength_unit: mm\n"
                                              "frames: {kind: points, pattern: f%d.csv, count: "
                                           << frames << ", rate: 1 Hz}\n";
  Recording recording = LoadRecording(folder / "recording.yaml");
  std::vector<int> all;
  for (int f = 0; f < frames; ++f) all.push_back(f);
  ConvertTrackedPointsToMarkers(all, &recording);
  return recording;
}

TEST(TrackedPoints, AreWeightedByTheirExpectedDeviation) {
  const TemporaryFolder folder;
  // Half of the points are three times as uncertain; one fails in the second frame, and one is
  // hardly uncertain at all.
  const Recording recording = Correlated(
      folder, 2, 41,
      [](int f, int i) {
        if (f == 1 && i == 4) return -1.0;
        return i == 0 ? 1e-6 : i % 2 == 0 ? 0.01 : 0.03;
      },
      [](int, int) { return 0.0; });
  ASSERT_EQ(recording.markers.weights.size(), 2u);
  const Eigen::VectorXd& weights = recording.markers.weights[1];
  ASSERT_EQ(weights.size(), 41);
  EXPECT_EQ(weights[2], 1) << "a typical point";
  EXPECT_NEAR(weights[1], 1.0 / 9, 1e-12);
  EXPECT_EQ(weights[0], 16) << "no point counts as more than sixteen typical ones";
  const TetMesh mesh = BarMesh({8, 2, 2}, 1);
  const Observed observed = MarkerObserver(recording, mesh).Observe(1, mesh.nodes.reshaped());
  EXPECT_EQ(observed.count[4], 0);
  EXPECT_EQ(observed.count[1], weights[1]);
  EXPECT_EQ(observed.used, 40);
}

TEST(TrackedPoints, HaveNoWeightsWhereTheTablesGiveNone) {
  const TemporaryFolder folder;
  EXPECT_TRUE(Correlated(
                  folder, 2, 8, [](int, int) { return 0.0; }, [](int, int) { return 0.0; })
                  .markers.weights.empty());
  // The reference image, correlated with itself, has no error.
  const Recording recording = Correlated(
      folder, 2, 8, [](int f, int i) { return f * (i + 1) * 0.01; }, [](int, int) { return 0.0; });
  EXPECT_EQ(recording.markers.weights[0], Eigen::VectorXd::Ones(8));
  EXPECT_GT(recording.markers.weights[1][0], 1);
}

// The weights make the noise of all points that of a typical one.
TEST(TrackedPoints, ShowTheNoiseOfATypicalPoint) {
  const TemporaryFolder folder;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto sigma = [](int, int i) { return i % 2 == 0 ? 0.02 : 0.08; };
  PredictedRecording item;
  item.recording = Correlated(folder, 30, 61, sigma,
                              [&](int f, int i) { return 0.5 * sigma(f, i) * normal(random); });
  for (int f = 0; f < 30; ++f) item.frames.push_back(f);
  // 10 µm; 31 points of 30 frames in three coordinates determine it to about 2 %. The rms over all
  // points is 29 µm.
  EXPECT_NEAR(EstimateRecordingNoise(item, item.frames), 1e-5, 1e-6);
}

}  // namespace
}  // namespace lacuna
