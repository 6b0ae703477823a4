// The drop of Figure 1, and how its numbers are read off a motion.
#include "paper/drop_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "paper/drop_figure.h"
#include "support/box_mesh.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kGravity = 9.80665;  // m/s²

DropStudy ReadFigure1() {
  return ReadDrop(
      Config::Load(std::filesystem::path(LACUNA_SOURCE_DIR) / "experiments/figures/figure1.yaml"));
}

// A cube of 0.1 m that falls at 1 m/s from 10 mm, is 12 mm shorter while it touches the floor for
// 20 ms, leaves at 0.6 m/s and swings in height at 80 Hz; made up, sampled at 2 kHz.
SceneMotion MadeUpBounce() {
  constexpr double kTouch = 0.0101, kLeave = 0.0301, kStep = 5e-4;
  SceneMotion motion;
  motion.status = SceneMotion::Status::kFinished;
  motion.body = std::make_shared<Body>(MakeBody(
      BoxMesh(Eigen::Vector3d(0, 0, 0.01), Eigen::Vector3d(0.1, 0.1, 0.11), {1, 1, 1}), 1000));
  const Eigen::Matrix3Xd rest = motion.body->mesh.nodes;
  const auto place = [&](double time, double* stretch, double* lowest) {
    if (time < kTouch) {
      *lowest = 0.01 * (1 - time / kTouch);
    } else if (time < kLeave) {
      *lowest = -1e-5;
      *stretch -= 0.12 * std::sin(std::numbers::pi * (time - kTouch) / (kLeave - kTouch));
    } else {
      const double flight = time - kLeave;
      *stretch += 0.02 * std::sin(2 * std::numbers::pi * 80 * flight);
      // The centre flies on a parabola, whatever the swing.
      *lowest = 0.05 + 0.6 * flight - 0.5 * kGravity * flight * flight - 0.05 * *stretch;
    }
  };
  for (int k = 0; k < 200; ++k) {
    const double time = kStep * k;
    double stretch = 1, lowest = 0;
    place(time, &stretch, &lowest);
    Eigen::Matrix3Xd nodes = rest;
    nodes.row(2) = (rest.row(2).array() - 0.01) * stretch + lowest;
    Eigen::Matrix3Xd velocities = Eigen::Matrix3Xd::Zero(3, rest.cols());
    velocities.row(2).setConstant(time < kLeave ? -1 : 0.6 - kGravity * (time - kLeave));
    motion.times.push_back(time);
    motion.positions.push_back(nodes);
    motion.velocities.push_back(velocities);
  }
  return motion;
}

TEST(DropStudyTest, NumbersAreReadOffAMadeUpBounce) {
  const DropNumbers numbers = MeasureDrop(ReadFigure1().scene, MadeUpBounce());
  // Between samples 0.5 ms apart the gap is taken to be a line, which the touch and the leaving
  // bend: both are off by less than a step.
  EXPECT_NEAR(numbers.touch_time, 0.0101, 5e-4);
  EXPECT_NEAR(numbers.contact_time, 0.02, 5e-4);
  EXPECT_NEAR(numbers.compression, 0.12, 1e-4);  // a parabola through the top of a sine
  // The time of leaving is off by some 0.3 ms of gravity.
  EXPECT_NEAR(numbers.rebound_speed, 0.6, 4e-3);
  EXPECT_NEAR(numbers.rebound_height, 0.6 * 0.6 / (2 * kGravity), 1e-4);
  // Hann's window over 5.6 periods: leakage of the other side of the spectrum, under a per cent.
  EXPECT_NEAR(numbers.frequency, 80, 0.8);
  EXPECT_GT(numbers.peak_force, 0);
}

TEST(DropStudyTest, WithoutALandingNothingOfItIsMeasured) {
  SceneMotion motion = MadeUpBounce();
  for (Eigen::Matrix3Xd& nodes : motion.positions) nodes.row(2).array() += 1;
  const DropNumbers numbers = MeasureDrop(ReadFigure1().scene, motion);
  EXPECT_TRUE(std::isnan(numbers.touch_time));
  EXPECT_TRUE(std::isnan(numbers.contact_time));
  EXPECT_TRUE(std::isnan(numbers.frequency));
}

TEST(DropStudyTest, MeshesComeCloseToThoseOfThePaper) {
  const DropStudy study = ReadFigure1();
  ASSERT_EQ(study.meshes.size(), 6u);
  for (const DropMesh& mesh : study.meshes) {
    Scene scene = SceneOf(study, mesh, 1);
    scene.frames = 1;
    SilentProgress progress;
    const SceneMotion motion = SimulateScene(scene, &progress);
    ASSERT_TRUE(motion.IsUsable()) << motion.message;
    // Sizes are what can be chosen; counts come in jumps.
    EXPECT_NEAR(motion.body->NodeCount(), mesh.paper_nodes, 0.05 * mesh.paper_nodes)
        << "order " << mesh.settings.order;
  }
}

// With one coarse mesh.
DropStudy CoarseFigure1() {
  DropStudy study = ReadFigure1();
  DropMesh coarse = study.meshes.front();
  coarse.edge_length = 0.03;
  coarse.settings.tets.max_volume = 2e-5;
  study.meshes = {coarse};
  return study;
}

TEST(DropStudyTest, ACoarseBodyBouncesAndItsEnergyDoesNotGrow) {
  DropStudy study = CoarseFigure1();
  study.scene.frame_rate /= 2;  // coarser in time, too
  study.scene.frames /= 2;
  const TemporaryFolder folder;
  SilentProgress progress;
  const std::vector<DropRun> runs = RunDrop(study, folder / "drop", &progress);
  ASSERT_EQ(runs.size(), 1u);
  const DropNumbers& numbers = runs[0].numbers;
  const Scene& scene = study.scene;
  const double lowest = scene.bar.centre.z() - 0.5 * scene.bar.size.z();
  const double speed = -scene.bar.velocity.z();
  // BDF2 begins with a step of implicit Euler, of 1 ms: some 1e-5 m of fall.
  const double touch = (std::sqrt(speed * speed + 2 * kGravity * lowest) - speed) / kGravity;
  EXPECT_NEAR(numbers.touch_time, touch, 2e-5);
  EXPECT_GT(numbers.contact_time, 5e-3);
  EXPECT_LT(numbers.contact_time, 0.06);
  EXPECT_GT(numbers.compression, 0.05);
  EXPECT_LT(numbers.compression, 0.5);
  EXPECT_GT(numbers.rebound_speed, 0.2 * speed);
  EXPECT_LT(numbers.rebound_speed, speed);
  EXPECT_LT(numbers.energy_growth, 1e-3);
  EXPECT_LT(numbers.energy_left, 1);
  EXPECT_NEAR(runs[0].halved.rebound_speed / numbers.rebound_speed, 1, 0.1);

  const PanelPicture picture = DropPicture(study, runs, 1);
  EXPECT_EQ(picture.panels.size(), study.instants.size());
  for (const Panel& panel : picture.panels) {
    ASSERT_EQ(panel.surfaces.size(), 2u) << "floor and body";
    EXPECT_EQ(panel.surfaces[1].vertex_values.size(), panel.surfaces[1].mesh.vertices.cols());
  }
  EXPECT_LT(picture.panels[0].surfaces[1].vertex_values.maxCoeff(), 1e-6) << "nothing strained";
  EXPECT_TRUE(DropPicture(study, runs, 2).panels.empty());
}

TEST(DropStudyTest, ASimulationThatIsKeptIsNotRepeated) {
  DropStudy study = CoarseFigure1();
  study.scene.frames = 3;
  const TemporaryFolder folder;
  SilentProgress progress;
  const std::vector<DropRun> made = RunDrop(study, folder / "drop", &progress);
  // Were it simulated again, the motion would have one frame.
  study.scene.frames = 1;
  const std::vector<DropRun> kept = RunDrop(study, folder / "drop", &progress);
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(kept[0].motion.times, made[0].motion.times);
  EXPECT_EQ(kept[0].motion.times.size(), 3u);
  EXPECT_EQ(kept[0].motion.positions, made[0].motion.positions);
  EXPECT_EQ(ToJson(kept[0].numbers), ToJson(made[0].numbers));
  EXPECT_EQ(ToJson(kept[0].halved), ToJson(made[0].halved));
  EXPECT_EQ(DropText(kept), DropText(made));
  EXPECT_EQ(kept[0].motion.body->mesh.tets, made[0].motion.body->mesh.tets);
  EXPECT_EQ(kept[0].motion.body->weight, made[0].motion.body->weight);

  study.scene_configuration["density"] = 1;  // another scene
  EXPECT_EQ(RunDrop(study, folder / "drop", &progress)[0].motion.times.size(), 1u);
}

TEST(DropStudyTest, NumbersThatWereNotMeasuredStayUnmeasured) {
  DropNumbers numbers;
  numbers.contact_time = 0.02;
  const DropNumbers read = DropNumbersFrom(nlohmann::json::parse(ToJson(numbers).dump()));
  EXPECT_EQ(read.contact_time, 0.02);
  EXPECT_TRUE(std::isnan(read.touch_time));
}

TEST(DropStudyTest, ASceneWithoutFloorIsRefused) {
  const TemporaryFolder folder;
  const auto scenes = std::filesystem::path(LACUNA_SOURCE_DIR) / "experiments/scenes";
  const std::string text =
      "scene: " + (scenes / "bend.yaml").string() + "\nschema_version: 1\ninstants: [0 s]\n";
  EXPECT_THAT([&] { ReadDrop(Config::Parse(text, "drop.yaml")); },
              ThrowsMessage<InputError>(HasSubstr("plane_contact")));
}

}  // namespace
}  // namespace lacuna
