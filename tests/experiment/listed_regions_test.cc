#include "experiment/listed_regions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <string>

#include "core/error.h"
#include "geometry/mesh_io.h"
#include "geometry/rounded_box.h"
#include "prediction/predicted_body.h"
#include "support/held_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

const std::string kClampedFace = "half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}";

// A study of a bar whose clamp is described by `clamp`, with texts of the experiment replaced.
PredictionStudy StudyOfBar(const TemporaryFolder& folder, const std::string& clamp,
                           const std::map<std::string, std::string>& replaced = {}) {
  std::vector<Eigen::Matrix3Xd> frames(kFrames, BarMarkerPlaces());
  frames[kFrames / 3].row(1).array() += 0.003;
  WriteBarRecording(folder.Path(), frames);
  const std::filesystem::path file = folder / "recording.yaml";
  std::string text = FileContent(file);
  text.replace(text.find(kClampedFace), kClampedFace.size(), clamp);
  std::ofstream(file) << text;
  return ReadBarStudy(folder.Path(), replaced);
}

// The list of the vertices of box.off on the plane x = 0.
std::string ListOfEnd(const TemporaryFolder& folder) {
  WriteBox(folder / "box.off");
  const Eigen::Matrix3Xd vertices = ReadTriMesh(folder / "box.off").mesh.vertices;
  std::string list;
  for (Eigen::Index i = 0; i < vertices.cols(); ++i)
    if (vertices(0, i) == 0) list += (list.empty() ? "" : ", ") + std::to_string(i);
  return "nodes: [" + list + "]";
}

TEST(ListedRegions, HoldTheNodesThatTheirFaceHas) {
  const TemporaryFolder folder;
  const PredictionStudy study = StudyOfBar(folder, ListOfEnd(folder));
  const TetMesh mesh = MakeReferenceBody(study).mesh;
  ASSERT_EQ(mesh.Order(), 2);
  Region clamp = study.recordings[0].recording.object.fixed.at(0).region;
  const std::vector<int> nodes = SelectNodes(clamp, mesh);
  const Region face{"face", HalfSpaceRegion{{0.002, 0, 0}, -Eigen::Vector3d::UnitX()}};
  EXPECT_EQ(nodes, SelectNodes(face, mesh));
  EXPECT_GT(nodes.size(), std::get<NodeRegion>(clamp.shape).nodes.size());
  // A recording whose reference is the mesh itself lists them all.
  ListNodesOfMesh(mesh, {&clamp});
  EXPECT_EQ(std::get<NodeRegion>(clamp.shape).nodes, nodes);
  EXPECT_EQ(SelectNodes(clamp, mesh), nodes);
}

TEST(ListedRegions, AreRefusedWhereTheNumbersAreNotThoseOfTheMesh) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { StudyOfBar(folder, "nodes: [0, 8]"); },
              ThrowsMessage<InputError>(AllOf(
                  HasSubstr("box.off"), HasSubstr("\"clamp\" lists node 8; there are 8 nodes"))));
  const std::map<std::string, std::string> divided{{"order: 2", "preserve_surface: false"}};
  EXPECT_THAT([&] { StudyOfBar(folder, "nodes: [0, 1, 2]", divided); },
              ThrowsMessage<InputError>(AllOf(
                  HasSubstr("region \"clamp\" lists nodes by their numbers, but they are "
                            "vertices of the given surface"),
                  HasSubstr("`mesh: {preserve_surface: false}` adds others"),
                  HasSubstr("set `preserve_surface: true`; or describe the region by a box"))));
  EXPECT_NO_THROW(StudyOfBar(folder, kClampedFace, divided));
}

TEST(ListedRegions, OfAFirstFrameNeedATrackedMesh) {
  const TemporaryFolder folder;
  const TriMesh box = RoundedBox({0.05, 0, 0}, {0.1, 0.03, 0.03}, 0, 0.01);
  WriteTriMesh(folder / "f_00.ply", box);
  WriteTriMesh(folder / "f_01.ply", box);
  Region region{"clamp", NodeRegion{{0, 1}}};
  for (const bool tracked : {false, true}) {
    std::ofstream(folder / "recording.yaml")
        << "schema_version: 1\nname: bar\nlength_unit: m\nframes: {kind: mesh, files: f_*.ply, "
        << "rate: 10 Hz, tracked: " << (tracked ? "true" : "false") << "}\n";
    const Recording recording = LoadRecording(folder.Path());
    const auto number = [&] { NumberListedNodes(recording, {}, {&region}); };
    if (tracked)
      number();
    else
      EXPECT_THAT(number, ThrowsMessage<InputError>(HasSubstr("surface that is reconstructed")));
  }
  EXPECT_EQ(std::get<NodeRegion>(region.shape).file_nodes, box.vertices.cols());
}

TEST(ListedRegions, AreRefusedWhereVerticesOfTheFileAreLeftOut) {
  const TemporaryFolder folder;
  TriMesh box = RoundedBox({0.05, 0, 0}, {0.1, 0.03, 0.03}, 0, 0.01);
  box.vertices.conservativeResize(3, box.vertices.cols() + 1);
  box.vertices.rightCols(1).setOnes();
  WriteTriMesh(folder / "f_00.ply", box);
  Region region{"clamp", NodeRegion{{0, 1}}};
  for (const char* reference : {"", "reference: {from: mesh, file: f_00.ply}\n"}) {
    std::ofstream(folder / "recording.yaml")
        << "schema_version: 1\nname: bar\nlength_unit: m\n"
        << reference << "frames: {kind: mesh, files: f_00.ply, rate: 10 Hz, tracked: true}\n";
    const Recording recording = LoadRecording(folder.Path());
    EXPECT_THAT([&] { NumberListedNodes(recording, {}, {&region}); },
                ThrowsMessage<InputError>(HasSubstr("which would shift the numbers")));
  }
}

}  // namespace
}  // namespace lacuna
