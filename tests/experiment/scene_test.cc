// The scenes of experiments/scenes, on coarser meshes, do what physics says.
#include "experiment/scene.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "analysis/measure.h"
#include "scan/recording.h"
#include "scan/scan_writer.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using Edits = std::vector<std::pair<std::string, std::string>>;

Scene ReadEdited(const std::string& name, const Edits& edits) {
  const auto file = std::filesystem::path(LACUNA_SOURCE_DIR) / "experiments/scenes" / name;
  std::string text = FileContent(file);
  for (const auto& [from, to] : edits) {
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
  }
  return ReadScene(Config::Parse(text, file.string()));
}

SceneMotion Simulate(const Scene& scene) {
  SilentProgress progress;
  return SimulateScene(scene, &progress);
}

const Edits kCoarserHeldBar{{"edge_length: 6 mm", "edge_length: 12 mm"},
                            {"quadratic.yaml", "quadratic.yaml, max_volume: 500 mm^3"},
                            {"cameras.yaml", "cameras.yaml\n  width: 64\n  height: 48"}};

Eigen::Matrix3Xd RestOf(const SceneMotion& motion, const Eigen::VectorXi& nodes) {
  return motion.body->mesh.nodes(Eigen::all, nodes);
}

// The recording that the scanner of a scene makes is an ordinary one, and its points lie on the
// true surfaces to the scanner's noise.
Recording ExpectReadable(const Scene& scene, const SceneMotion& motion,
                         const std::filesystem::path& folder) {
  WriteSceneRecording(scene, motion, folder);
  Recording recording = LoadRecording(folder);
  EXPECT_EQ(recording.FrameCount(), scene.frames);
  EXPECT_EQ(recording.object.density, scene.density);
  for (const int i : {0, scene.frames / 2, scene.frames - 1}) {
    EXPECT_NEAR(recording.times[i], i / scene.frame_rate, 1e-6);
    const Frame frame = LoadFrame(recording, i);
    EXPECT_GT(frame.cloud.points.cols(), 500);
    const LengthSummary distance = DistanceToSurface(
        BoundaryAt(motion.body->boundary, motion.positions[i]), frame.cloud.points);
    // |N(0, σ)| has the mean 0.8 σ; at edges, where pixels fly, more.
    EXPECT_LT(distance.mean, 1.5 * scene.scanner->options.noise) << "frame " << i;
    EXPECT_GT(distance.mean, 0.3 * scene.scanner->options.noise) << "frame " << i;
  }
  return recording;
}

TEST(BendScene, BendsInThePlaneOfItsForceAndIsHeldAtItsClamp) {
  const TemporaryFolder folder;
  const Scene scene = ReadEdited("bend.yaml", kCoarserHeldBar);
  const SceneMotion motion = Simulate(scene);
  ASSERT_TRUE(motion.IsUsable()) << motion.message;
  const Eigen::VectorXi clamp = NodesIn(scene.grips[0].region, motion.body->mesh);
  const Eigen::VectorXi tip = NodesIn(scene.loads[0].region, motion.body->mesh);
  const Eigen::Vector3d force = scene.loads[0].force;
  for (size_t k = 0; k < motion.times.size(); ++k) {
    EXPECT_EQ(motion.positions[k](Eigen::all, clamp), RestOf(motion, clamp));
    // The force grows over 0.6 s and stays.
    const double share = std::min(1.0, motion.times[k] / 0.6);
    EXPECT_LT((motion.load[k] - share * force).norm(), 1e-12);
    if (k == 0) continue;
    // The section is a square, bends alike in all directions, and so deflects along the force.
    const Eigen::Vector3d deflection =
        (motion.positions[k](Eigen::all, tip) - RestOf(motion, tip)).rowwise().mean();
    const double angle =
        std::atan2(deflection.y(), deflection.z()) - std::atan2(force.y(), force.z());
    // The coarse mesh is not symmetric: a few per cent of stiffness.
    EXPECT_NEAR(std::remainder(angle, 2 * std::numbers::pi), 0, 0.05) << "frame " << k;
  }
  const Recording recording = ExpectReadable(scene, motion, folder / "bend");
  EXPECT_EQ(recording.object.fixed.size(), 1u);
}

TEST(TwistScene, TurnsTheChuckByTheStatedAngleAndTheMiddleByHalf) {
  const TemporaryFolder folder;
  const Scene scene = ReadEdited("twist.yaml", kCoarserHeldBar);
  const SceneMotion motion = Simulate(scene);
  ASSERT_TRUE(motion.IsUsable()) << motion.message;
  const Eigen::VectorXi clamp = NodesIn(scene.grips[0].region, motion.body->mesh);
  const Eigen::VectorXi chuck = NodesIn(scene.grips[1].region, motion.body->mesh);
  ASSERT_GT(chuck.size(), 10);
  const Eigen::Vector3d centre(0.1, 0.015, 0.015);
  for (size_t k = 0; k < motion.times.size(); ++k) {
    EXPECT_EQ(motion.positions[k](Eigen::all, clamp), RestOf(motion, clamp));
    const double angle = 0.5 * std::numbers::pi * std::min(1.0, motion.times[k] / 0.6);
    const Eigen::AngleAxisd turn(angle, Eigen::Vector3d::UnitX());
    const Eigen::Matrix3Xd turned =
        (turn.toRotationMatrix() * (RestOf(motion, chuck).colwise() - centre)).colwise() + centre;
    EXPECT_LT((motion.positions[k](Eigen::all, chuck) - turned).norm(), 1e-12) << "frame " << k;
  }
  // Free nodes near the middle, at rest again: turned about the axis by half of 90° plus their
  // share of the length between the grips, which the rounded edges leave uniform.
  double largest_error = 0;
  int checked = 0;
  for (int i = 0; i < motion.body->NodeCount(); ++i) {
    const Eigen::Vector3d rest = motion.body->mesh.nodes.col(i) - centre;
    if (std::abs(rest.x() + 0.05) > 0.02 || rest.tail<2>().norm() < 0.01) continue;
    const Eigen::Vector3d now = motion.positions.back().col(i) - centre;
    const double angle = std::atan2(rest.y() * now.z() - rest.z() * now.y(),
                                    rest.y() * now.y() + rest.z() * now.z());
    const double expected = 0.5 * std::numbers::pi * (rest.x() + 0.1 - 0.008) / 0.084;
    largest_error = std::max(largest_error, std::abs(angle - expected));
    ++checked;
  }
  ASSERT_GT(checked, 20);
  // Warping of the section and its not being quite at rest: some degrees.
  EXPECT_LT(largest_error, 8 * std::numbers::pi / 180);
  const Recording recording = ExpectReadable(scene, motion, folder / "twist");
  EXPECT_EQ(recording.object.fixed.size(), 1u) << "the clamp is told, the moved chuck is not";
  EXPECT_TRUE(recording.object.grips.empty());
}

// A bar that is stretched between two load cells.
TEST(TwistScene, ItsLoadCellsReadTheForcesOfTheGrips) {
  const TemporaryFolder folder;
  Edits edits = kCoarserHeldBar;
  edits.push_back(
      {"normal: [-1, 0, 0]}}\n", "normal: [-1, 0, 0]}}\n    measured_force: {deviation: 20 mN}\n"});
  edits.push_back({"    angle: 90 deg\n",
                   "    translation: [4 mm, 0, 0]\n    measured_force: {deviation: 20 mN}\n"});
  const Scene scene = ReadEdited("twist.yaml", edits);
  const SceneMotion motion = Simulate(scene);
  ASSERT_TRUE(motion.IsUsable()) << motion.message;
  ASSERT_EQ(motion.reactions.rows(), 6);
  ASSERT_EQ(motion.reactions.cols(), scene.frames);
  EXPECT_LT(motion.reactions.col(0).norm(), 1e-9) << "nothing is deformed at first";
  // At rest again both pull with the same force, to the last of the vibration: E A ε, and more
  // where the grips hinder the lateral contraction.
  const Eigen::VectorXd last = motion.reactions.rightCols<1>();
  EXPECT_GT(last[3], 0);
  EXPECT_NEAR(last[0], -last[3], 0.05 * last[3]);
  EXPECT_LT(std::abs(last[4]) + std::abs(last[5]), 0.05 * last[3]);

  const Recording recording = ExpectReadable(scene, motion, folder / "stretch");
  ASSERT_EQ(recording.object.fixed.size(), 1u);
  ASSERT_EQ(recording.object.grips.size(), 1u) << "the chuck is told, as its force is measured";
  EXPECT_LT((MotionAt(recording.object.grips[0], 0.3).translation() - Eigen::Vector3d(0.002, 0, 0))
                .norm(),
            1e-6);
  ASSERT_EQ(recording.object.reactions.size(), 2u);
  double squares = 0, count = 0;
  for (size_t k = 0; k < 2; ++k) {
    const MeasuredReaction& reading = recording.object.reactions[k];
    EXPECT_EQ(reading.held, k);
    EXPECT_EQ(reading.name, scene.grips[k].region.name);
    const Eigen::MatrixXd noise =
        reading.values - motion.reactions.middleRows<3>(3 * static_cast<Eigen::Index>(k));
    squares += noise.squaredNorm();
    count += static_cast<double>(noise.size());
  }
  EXPECT_NEAR(std::sqrt(squares / count), 0.02, 0.004);  // 96 draws
}

TEST(Scene, RecordsTheTorqueOfAGripThatTurns) {
  const TemporaryFolder folder;
  Edits edits = kCoarserHeldBar;
  edits.push_back(
      {"    angle: 90 deg\n", "    angle: 30 deg\n    measured_torque: {deviation: 0.1 N mm}\n"});
  const Scene scene = ReadEdited("twist.yaml", edits);
  const SceneMotion motion = Simulate(scene);
  ASSERT_TRUE(motion.IsUsable()) << motion.message;
  ASSERT_EQ(motion.torques.rows(), 6);
  // The driven grip turns the bar about its axis, the other one holds it.
  const Eigen::VectorXd last = motion.torques.rightCols<1>();
  EXPECT_GT(last[3], 0);
  EXPECT_NEAR(last[0], -last[3], 0.05 * last[3]);
  WriteSceneRecording(scene, motion, folder.Path());
  const Recording recording = LoadRecording(folder.Path());
  ASSERT_EQ(recording.object.reactions.size(), 1u);
  const MeasuredReaction& reading = recording.object.reactions[0];
  EXPECT_TRUE(reading.is_torque);
  EXPECT_EQ(reading.deviation, 1e-4);
  EXPECT_NEAR(reading.values(0, reading.values.cols() - 1), last[3], 5e-4);
  const RecordedGrip& grip = recording.object.grips.at(0);
  const Eigen::AngleAxisd turn(MotionAt(grip, recording.times.back()).linear());
  EXPECT_NEAR(turn.angle(), std::numbers::pi / 6, 1e-9);
}

// What a body that falls has, J.
struct MechanicalEnergy {
  double kinetic = 0, elastic = 0, gravity = 0;
  double Total() const { return kinetic + elastic + gravity; }
};

MechanicalEnergy EnergyAt(const Scene& scene, const SceneMotion& motion, size_t frame) {
  const Eigen::VectorXd position = motion.positions[frame].reshaped();
  const Eigen::VectorXd velocity = motion.velocities[frame].reshaped();
  const Eigen::VectorXd state;
  MechanicalEnergy energy;
  energy.kinetic =
      0.5 * motion.velocities[frame].colwise().squaredNorm().dot(motion.body->node_mass);
  for (const auto& effect : scene.effects) {
    const auto stored = effect->Energy({*motion.body, position, velocity, velocity, 0, 0, state});
    if (effect->Card().type == "neo_hookean") energy.elastic = *stored;
    if (effect->Card().type == "gravity") energy.gravity = *stored;
  }
  return energy;
}

TEST(DropScene, FallsFreelyStaysAboveTheFloorAndReboundsWithLessEnergy) {
  const TemporaryFolder folder;
  const Scene scene =
      ReadEdited("drop.yaml", {{"edge_length: 8 mm", "edge_length: 14 mm"},
                               {"max_volume: 250 mm^3", "max_volume: 1000 mm^3"},
                               {"frames: 18", "frames: 11"},
                               {"cameras.yaml", "cameras.yaml\n  width: 64\n  height: 48"}});
  const SceneMotion motion = Simulate(scene);
  ASSERT_TRUE(motion.IsUsable()) << motion.message;
  const Eigen::VectorXd share = motion.body->node_mass / motion.body->node_mass.sum();
  constexpr double kGravity = 9.80665;  // m/s²
  const double time_step = 1 / (scene.frame_rate * scene.steps_per_frame);

  std::vector<double> height, lowest;
  for (const Eigen::Matrix3Xd& nodes : motion.positions) {
    height.push_back(nodes.row(2).dot(share));
    lowest.push_back(nodes.row(2).minCoeff());
  }
  const size_t touch =
      std::find_if(lowest.begin(), lowest.end(), [](double z) { return z < 1e-4; }) -
      lowest.begin();
  ASSERT_GE(touch, 3u);
  ASSERT_LT(touch, lowest.size());
  for (size_t k = 0; k < touch; ++k) {
    // BDF2 is exact for a parabola but for its first step, one of implicit Euler, whose error of
    // ½ g h² grows by 3/2 in the steps after it.
    const double fall = 0.5 * kGravity * motion.times[k] * motion.times[k];
    EXPECT_NEAR(height[0] - height[k], fall, 0.76 * kGravity * time_step * time_step)
        << "frame " << k;
    EXPECT_LT(EnergyAt(scene, motion, k).elastic, 1e-9) << "nothing strains a falling body";
  }
  // A point that lands at 0.8 m/s meets ρ c v ~ 10 kPa and sinks 0.1 mm into 100 MPa/m; a rounded
  // end of little area some times that.
  EXPECT_GT(*std::min_element(lowest.begin(), lowest.end()), -5e-4);
  EXPECT_LT(*std::min_element(lowest.begin(), lowest.end()), 0);

  const double initial = EnergyAt(scene, motion, 0).Total();
  const double impact = 0.5 * kGravity * std::pow(motion.times[touch - 1], 2);
  const double scale = motion.body->node_mass.sum() * kGravity * impact;
  for (size_t k = 0; k < motion.times.size(); ++k) {
    EXPECT_LT(EnergyAt(scene, motion, k).Total(), initial + 1e-3 * scale) << "frame " << k;
  }
  // Its centre falls by 44 mm, of which the first bounce gives back some 10 mm, and there is a
  // frame in which no point touches the floor.
  ASSERT_GE(height.size(), touch + 4);
  const auto bottom = std::min_element(height.begin() + touch, height.begin() + touch + 3);
  const double top = *std::max_element(bottom, height.end());
  EXPECT_GT(top - *bottom, 5e-3);
  EXPECT_LT(top, height[0]);
  EXPECT_GT(*std::max_element(lowest.begin() + touch, lowest.end()), 2e-4);

  const Recording recording = ExpectReadable(scene, motion, folder / "drop");
  EXPECT_TRUE(recording.object.fixed.empty());
  ASSERT_TRUE(recording.object.gravity.has_value());
  EXPECT_NEAR(recording.object.gravity->z(), -kGravity, 1e-9);
}

}  // namespace
}  // namespace lacuna
