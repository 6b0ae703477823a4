// The scenes of a report's document: points with their noise, frames, and measured forces.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "record/packed_array.h"
#include "report/small_report.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(ReportDocument, ScenesHaveTheFramesOfTheMotionAndAllFramesAsSeries) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  const json scenes = ShownScenes(folder / "bar");
  ASSERT_EQ(scenes.size(), 2u);
  const json& scene = scenes.at(0);
  EXPECT_EQ(scene.at("times"), json({0.0, 0.1, 0.3}));
  EXPECT_EQ(scene.at("fitted"), json({true, true, false}));
  EXPECT_EQ(scene.at("up"), json({0.0, 0.0, 1.0}));
  EXPECT_EQ(Unpack(scene.at("surface").at("positions")).shape, (std::vector<int>{3, 3, 3}));
  const UnpackedArray measured = Unpack(scene.at("points").at("measured"));
  EXPECT_EQ(measured.shape, (std::vector<int>{3, 2, 3}));
  EXPECT_NEAR(measured.values(2, 1), 0.01, 1e-6);  // frame 10
  EXPECT_NEAR(Unpack(scene.at("points").at("residual")).values(2, 1), 3e-4, 1e-8);
  EXPECT_EQ(scene.at("points").at("names"), json({"root", "tip"}));
  EXPECT_EQ(scene.at("series").at("time_s").size(), 40u);
  EXPECT_NEAR(scene.at("series").at("rms_m").at(7).get<double>(), 3e-4, 1e-12);
  EXPECT_TRUE(std::isnan(Unpack(scene.at("points_series").at("model")).values(5, 3)));
  // The second recording has no motion: its points are shown alone.
  EXPECT_TRUE(scenes.at(1).at("surface").is_null());
  EXPECT_EQ(scenes.at(1).at("times").size(), 40u);
}

TEST(ReportDocument, SeriesOfPointsAreExactWhereTheNoiseIsSmall) {
  const TemporaryFolder folder;
  CalibrationRecord record = SmallLedger().models[0].record;
  const auto series = [&](double noise) {
    record.noise = noise;
    WriteSmallFit(folder / "bar", {}, record);
    return ShownScenes(folder / "bar").at(0).at("points_series").at("measured");
  };
  // The positions span 0.06 m, so that a 16-bit step is 0.9 µm.
  EXPECT_EQ(series(1e-4).at("type"), "int16");
  const json precise = series(1e-6);
  EXPECT_EQ(precise.at("type"), "float32");
  // The second marker in frame 7: 0.06, 0.002, 0.007 m.
  EXPECT_NEAR(Unpack(precise).values(3, 7), 0.06, 4e-9);
  EXPECT_NEAR(Unpack(precise).values(5, 7), 0.007, 4e-9);
}

TEST(ReportDocument, PointsWithNoiseOfTheirOwnHaveTheirSigmaInEachFrame) {
  const TemporaryFolder folder;
  const auto run = [&](const std::vector<double>& sigmas) {
    WriteFit(folder / "bar", {.sigmas = sigmas});
    return ShownRun(folder / "bar");
  };
  const json own = run({1e-4, 1e-5});
  const json& scene = own.at("models").at(0).at("scenes").at(0);
  const UnpackedArray shown = Unpack(scene.at("points").at("sigmas"));
  EXPECT_EQ(shown.shape, (std::vector<int>{3, 2}));  // the frames of the motion
  const UnpackedArray all = Unpack(scene.at("points_series").at("sigmas"));
  EXPECT_EQ(all.shape, (std::vector<int>{40, 2}));
  // Steps of the packed numbers are at most a thousandth of the smallest σ.
  EXPECT_NEAR(shown.values(0, 2), 1e-4, 1e-8);
  EXPECT_NEAR(shown.values(1, 2), 1e-5, 1e-8);
  EXPECT_NEAR(all.values(1, 39), 1e-5, 1e-8);
  // What noise gives to the rms length of a frame: in frame 3 the second marker was not seen.
  const json& noise = scene.at("series").at("noise_m");
  EXPECT_EQ(noise.size(), 40u);
  EXPECT_NEAR(noise.at(2).get<double>(), std::sqrt(3.0 * (1 + 0.01) / 2) * 1e-4, 1e-12);
  EXPECT_NEAR(noise.at(3).get<double>(), std::sqrt(3.0) * 1e-4, 1e-12);
  EXPECT_TRUE(std::isnan(all.values(1, 3)));
  // 16-bit steps of 0.9 µm are too coarse for the second marker.
  EXPECT_EQ(scene.at("points_series").at("measured").at("type"), "float32");
  EXPECT_TRUE(own.at("noise").is_null());

  // The same noise for all points is that of the fit, and the page stays as it is.
  const json equal = run({1e-4, 1e-4});
  const json& other = equal.at("models").at(0).at("scenes").at(0);
  EXPECT_FALSE(other.at("points").contains("sigmas"));
  EXPECT_FALSE(other.at("points_series").contains("sigmas"));
  EXPECT_FALSE(other.at("series").contains("noise_m"));
  EXPECT_NEAR(equal.at("noise").get<double>(), std::sqrt(3.0) * 1e-4, 1e-12);
}

// A patch is the mean of some number of scanned points, which its σ follows.
TEST(ReportDocument, NoiseOfPatchesIsAlongTheirNormals) {
  const TemporaryFolder folder;
  CalibrationRecord record = SmallLedger().models[0].record;
  record.recordings[0].scan = FittedScan{Eigen::Matrix3Xd::Zero(3, 2), 2e-5, 1};
  WriteSmallFit(folder / "bar", {.sigmas = {1e-5, 3e-5}}, record);
  const json scenes = ShownScenes(folder / "bar");
  EXPECT_NEAR(scenes.at(0).at("series").at("noise_m").at(0).get<double>(), std::sqrt(5.0) * 1e-5,
              1e-12);
}

// Writes a fit with a load cell for the force along x and y and the torque about x in its first
// recording.
void WriteMeasuredFit(const std::filesystem::path& run, const std::string& forces) {
  CalibrationRecord record = SmallLedger().models[0].record;
  FittedReaction force, torque;
  force.name = torque.name = "jaw";
  force.labels = {"x", "y"};
  force.deviation = 0.02;
  torque.is_torque = true;
  torque.labels = {"x"};
  torque.deviation = 1e-4;
  for (FittedReaction* reaction : {&force, &torque})
    reaction->tare.assign(reaction->labels.size(), 0);
  record.recordings[0].reactions = {force, torque};
  WriteSmallFit(run, {}, record);
  const char* header = "recording,reaction,component,frame,time_s,fitted,";
  std::ofstream(run / "calibration/reactions.csv")
      << header << "displacement_m,measured_N,difference_N\n"
      << forces;
  std::ofstream(run / "calibration/torques.csv")
      << header << "rotation_rad,measured_N_m,difference_N_m\n0,1,0,0,0,1,0,0.001,0\n"
      << "0,1,0,2,2,0,0.1,0.003,-0.001\n";
}

TEST(ReportDocument, EveryMeasuredComponentIsACurveOverTimeAndOverTheMotionOfItsGrip) {
  const TemporaryFolder folder;
  // The second component has no reading in its second frame, and the grip hardly moves along it.
  WriteMeasuredFit(folder / "bar",
                   "0,0,0,0,0,1,0,0,0.01\n0,0,1,0,0,1,0,0.5,0\n"
                   "0,0,0,1,1,1,0.001,1,0\n0,0,1,1,1,1,0.00001,nan,nan\n"
                   "0,0,0,2,2,0,0.002,3,-0.5\n0,0,1,2,2,0,0.00002,0.25,0.5\n");
  const json curves = ShownScenes(folder / "bar").at(0).at("reactions");
  ASSERT_EQ(curves.size(), 3u);
  EXPECT_EQ(curves.at(0), json({{"reading", 0},
                                {"grip", "jaw"},
                                {"quantity", "force"},
                                {"unit", "N"},
                                {"component", "x"},
                                {"sigma", 0.02},
                                {"time_s", {0.0, 1.0, 2.0}},
                                {"fitted", {true, true, false}},
                                {"measured", {0.0, 1.0, 3.0}},
                                {"model", {0.01, 1.0, 2.5}},
                                {"motion", {0.0, 0.001, 0.002}}}));
  EXPECT_EQ(curves.at(1).at("component"), "y");
  EXPECT_EQ(curves.at(1).at("time_s"), json({0.0, 2.0}));
  EXPECT_EQ(curves.at(1).at("model"), json({0.5, 0.75}));
  EXPECT_TRUE(curves.at(1).at("motion").is_null());
  EXPECT_EQ(curves.at(2).at("quantity"), "torque");
  EXPECT_EQ(curves.at(2).at("unit"), "N m");
  EXPECT_EQ(curves.at(2).at("fitted"), json({true, false}));
  EXPECT_EQ(curves.at(2).at("motion"), json({0.0, 0.1}));
}

TEST(ReportDocument, RefusesReactionsThatTheFitDoesNotHave) {
  const TemporaryFolder folder;
  WriteMeasuredFit(folder / "bar", "0,0,2,0,0,1,0,0,0.01\n");
  EXPECT_THAT(WhyRefused({folder / "bar"}), HasSubstr("component 2 of reading 0 of a"));
}

}  // namespace
}  // namespace lacuna
