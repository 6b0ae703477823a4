#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/npy.h"
#include "geometry/mesh_io.h"
#include "scan/recording_fixture.h"
#include "support/shared_data.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// The published data sets, described as users would in a folder of their own.
class PublishedData : public RecordingTest {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(SharedData())) GTEST_SKIP() << "skipped, data absent";
  }
  static std::string Folder(const std::string& name) {
    return "data_folder: " + (SharedData() / name).string() + "\n";
  }
};

TEST_F(PublishedData, RubberStripIsATrackedSheet) {
  const Recording recording = Load(
      Yaml("  kind: points\n  pattern: frames/points_%02d.csv\n  count: 20\n  rate: 1 Hz\n"
           "  columns: {x: x_mm, y: y_mm, z: z_mm}\n  triangles: triangles.csv\n",
           Folder("rubber_strip") + "reference: {from: first_frame, sheet: {thickness: 1 mm}}\n"));
  EXPECT_EQ(recording.FrameCount(), 20);
  EXPECT_THAT(recording.warnings, IsEmpty());
  for (int i = 0; i < 20; ++i) {
    const Frame frame = LoadFrame(recording, i);
    EXPECT_EQ(frame.row_count, 435);
    EXPECT_EQ(frame.dropped_count > 0, i == 11 || i == 17) << "frame " << i;
  }
  EXPECT_EQ(LoadFrame(recording, 0).triangles.cols(), 722);
}

TEST_F(PublishedData, LiverGivesForcesNodesAndTetMesh) {
  const Recording recording = Load(Yaml(
      "  {kind: points, files: sequences/linear/s1/pointclouds/*.txt, rate: 1 Hz}\n",
      Folder("liver_sequence") +
          "fixed: [{nodes_file: mesh-remeshed/dirichlet-vertices.npy}]\n"
          "forces: [{file: sequences/linear/s1/true-forces.npy,\n"
          "          region: {nodes_file: sequences/linear/s1/forces-vertices-remeshed.npy}}]\n"
          "reference: {from: tet_mesh, file: mesh-remeshed/liver.msh}\n",
      "m"));
  EXPECT_EQ(recording.FrameCount(), 50);
  EXPECT_THAT(recording.warnings, IsEmpty());
  EXPECT_EQ(LoadFrame(recording, 49).cloud.Size(), 500);
  const Eigen::MatrixXd forces =
      ReadNpyMatrix(SharedData() / "liver_sequence/sequences/linear/s1/true-forces.npy");
  EXPECT_EQ(ForceAt(recording.object.forces[0], 30), Eigen::Vector3d(forces.row(30)));
  const TetMesh mesh = ReadTetMesh(recording.reference.file).mesh;
  EXPECT_EQ(SelectNodes(recording.object.fixed[0].region, mesh).size(), 106u);
  EXPECT_EQ(SelectNodes(*recording.object.forces[0].region, mesh).size(), 18u);
}

TEST_F(PublishedData, LidarScanHasItsCadShapeInCentimetres) {
  const Recording recording = Load(
      Yaml("  {kind: points, files: [h_m_c_beam.ply], sensors: [{position: [0, 0, 1 m]}]}\n",
           Folder("silicone_lidar") +
               "density: 1080 kg/m^3\ngravity: [0, -9.81 m/s^2, 0]\n"
               "reference: {from: mesh, file: cad/cantilever_f1494_v749.obj, length_unit: cm}\n",
           "m"));
  EXPECT_EQ(LoadFrame(recording, 0).cloud.Size(), 15091);
  EXPECT_THAT(recording.warnings, IsEmpty());
}

TEST_F(PublishedData, SiliconeBeamHasItsMarkersFromCsvAndC3d) {
  const std::string rest =
      Folder("silicone_beam") +
      "density: 1070 kg/m^3\nreference: {from: mesh, file: beam.stl, length_unit: mm}\n";
  const Recording csv =
      Load(Yaml("  {kind: markers, file: beam_gravity_V2_a.csv, columns: {time: t_s}, every: 10}\n",
                rest, "m"));
  EXPECT_EQ(csv.FrameCount(), 50);
  EXPECT_THAT(csv.markers.names, ElementsAre("tip1", "tip2", "tip3", "base1", "base2", "base3"));
  const Recording c3d =
      Load(Yaml("  {kind: markers, file: beam_gravity_V2_a.c3d, every: 10}\n", rest, "m"));
  EXPECT_EQ(c3d.FrameCount(), 50);
  EXPECT_EQ(LoadFrame(c3d, 49).cloud.Size(), 6);
  EXPECT_THAT(c3d.warnings, IsEmpty());
}

}  // namespace
}  // namespace lacuna
