#include "scan/recording_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "geometry/mesh_io.h"
#include "scan/recording.h"
#include "support/box_mesh.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

RecordedGrip TurningGrip() {
  RecordedGrip grip;
  grip.region = {"clamp", HalfSpaceRegion{{0.01, 0, 0}, -Eigen::Vector3d::UnitX()}};
  grip.motion = GripMotion::kGiven;
  grip.times = Eigen::Vector3d(-2, 0, 1);
  grip.displacements = Eigen::Matrix3Xd::Zero(3, 3);
  grip.displacements.col(2) << 0.001, -0.002, 0.003;
  grip.rotations = Eigen::Matrix3Xd::Zero(3, 3);
  grip.rotations.col(2) << 0.1, 0.2, -0.3;
  grip.pivot = {0.005, 0, 0};
  return grip;
}

TEST(RecordingWriter, WritesWhatIsReadBack) {
  const TemporaryFolder folder;
  const TetMesh mesh = BoxMesh({0, 0, 0}, {0.1, 0.02, 0.02}, {4, 1, 1}, 2);
  WriteTetMesh(folder / "object.msh", mesh);
  MarkerRecording written;
  written.name = "turned: once";
  written.comment = "Predicted.\nNothing of it was measured.";
  written.reference = folder / "object.msh";
  written.object.density = 1050;
  written.object.gravity = Eigen::Vector3d(0, 0, -9.8);
  RecordedGrip follower;
  follower.region = {"arm", SphereRegion{{0.1, 0.01, 0.01}, 0.02}};
  follower.motion = GripMotion::kFollowsMarkers;
  follower.markers = {"m 1", "b:2"};
  follower.deforms = true;
  written.object.grips = {TurningGrip(), follower};
  MeasuredForce force;
  force.name = "weight";
  force.region = Region{"tip", NodeRegion{{1, 3}, {}}};
  force.times = Eigen::Vector2d(0, 1);
  force.forces = Eigen::Matrix3Xd::Zero(3, 2);
  force.forces(2, 1) = -0.5;
  MeasuredForce constant;
  constant.name = "pull";
  constant.times = Eigen::VectorXd::Zero(1);
  constant.forces = Eigen::Vector3d(0.25, 0, 0);
  written.object.forces = {force, constant};
  written.times = {0, 0.5, 1};
  written.markers.names = {"m 1", "b:2"};
  written.markers.places = Eigen::Matrix3Xd::Zero(3, 2);
  written.markers.places.col(0) << 0.1, 0.02, 0.01;
  written.markers.places.col(1) << 0.1 / 3, 0, 0.01;
  written.instrument = {0.0025, true};
  for (int frame = 0; frame < 3; ++frame)
    written.markers.positions.emplace_back(written.markers.places.array() + 0.001 * frame);
  WriteMarkerRecording(folder / "made", written);
  EXPECT_FALSE(IsSimulatedRecording(folder / "made"));

  const Recording recording = LoadRecording(folder / "made");
  EXPECT_EQ(recording.name, written.name);
  EXPECT_THAT(FileContent(folder / "made/recording.yaml"),
              HasSubstr("# Predicted.\n# Nothing of it was measured.\n"));
  EXPECT_THAT(recording.times, ElementsAre(0, 0.5, 1));
  EXPECT_THAT(recording.markers.names, ElementsAre("m 1", "b:2"));
  EXPECT_LT((recording.markers.positions[2] - written.markers.positions[2]).norm(), 1e-9);
  EXPECT_EQ(recording.markers.places, written.markers.places);
  EXPECT_EQ(recording.instrument.subset, 0.0025);
  EXPECT_TRUE(recording.instrument.is_volume);
  EXPECT_EQ(*recording.object.density, 1050);
  EXPECT_EQ(*recording.object.gravity, *written.object.gravity);
  ASSERT_EQ(recording.object.grips.size(), 2u);
  for (const double time : {-1.0, 0.0, 0.3, 1.0})
    EXPECT_LT((MotionAt(recording.object.grips[0], time).matrix() -
               MotionAt(TurningGrip(), time).matrix())
                  .norm(),
              1e-12)
        << time;
  EXPECT_EQ(recording.object.grips[1].motion, GripMotion::kFollowsMarkers);
  EXPECT_TRUE(recording.object.grips[1].deforms);
  EXPECT_THAT(recording.object.grips[1].markers, ElementsAre("m 1", "b:2"));
  ASSERT_EQ(recording.object.forces.size(), 2u);
  EXPECT_EQ(ForceAt(recording.object.forces[0], 0.5).z(), -0.25);
  EXPECT_EQ(ForceAt(recording.object.forces[1], 1).x(), 0.25);
  // A table of one row would not cover the frames.
  EXPECT_TRUE(recording.object.forces[1].file.empty());
  EXPECT_EQ(SelectNodes(*recording.object.forces[0].region, mesh), (std::vector<int>{1, 3}));
  EXPECT_EQ(recording.reference.source, ReferenceSource::kTetMesh);
  EXPECT_EQ(ReadTetMesh(recording.reference.file).mesh.nodes, mesh.nodes);
}

TEST(RecordingWriter, ASimulatedRecordingIsRecognised) {
  const TemporaryFolder folder;
  EXPECT_FALSE(IsSimulatedRecording(folder / "absent"));
  MarkAsSimulated(folder.Path());
  EXPECT_TRUE(IsSimulatedRecording(folder.Path()));
  for (const std::string behind : {" ", " Or not."}) {
    std::ofstream(folder / "recording.yaml") << "# " << kSimulated << behind << "\nname: a\n";
    EXPECT_FALSE(IsSimulatedRecording(folder.Path())) << behind;
  }
  MarkerRecording written;
  written.comment = std::string(kSimulated) + "\nPlayed from bar.yaml.";
  written.reference = folder / "object.msh";
  written.times = {0};
  written.markers = {{"m"}, Eigen::Matrix3Xd::Zero(3, 1), {Eigen::Matrix3Xd::Zero(3, 1)}};
  WriteMarkerRecording(folder / "made", written);
  EXPECT_TRUE(IsSimulatedRecording(folder / "made"));
}

}  // namespace
}  // namespace lacuna
