#include "scan/region.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/npy.h"
#include "geometry/sheet.h"
#include "scan/similarity.h"
#include "scan/test_files.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const Eigen::Matrix3Xd kNodes =
    (Eigen::Matrix3Xd(3, 4) << 0, 0.01, 0.02, 0.03, 0, 0, 0, 0, 0, 0, 0.01, 0.01).finished();
const TetMesh kMesh{kNodes, Eigen::Vector4i(0, 1, 2, 3)};

Region Read(const std::string& yaml, const std::filesystem::path& folder = {}) {
  const Config config = Config::Parse(yaml, "recording.yaml");
  const Region region = ReadRegion(config, folder, "clamp");
  config.RefuseUnknownKeys();
  return region;
}

TEST(Region, SelectsTheNodesInsideEachShape) {
  const Region box = Read("box: {min: [0, -1 mm, -1 mm], max: [1 cm, 1 mm, 1 mm]}");
  EXPECT_THAT(SelectNodes(box, kMesh), ElementsAre(0, 1));  // the border belongs to the region
  const Region sphere = Read("sphere: {center: [0.02 m, 0, 0.01 m], radius: 10 mm}");
  EXPECT_THAT(SelectNodes(sphere, kMesh), ElementsAre(2, 3));
  const Region half_space = Read("half_space: {point: [15 mm, 0, 0], normal: [2, 0, 0]}");
  EXPECT_THAT(SelectNodes(half_space, kMesh), ElementsAre(2, 3));
  EXPECT_THAT(SelectNodes(Read("nodes: [3, 1, 3]"), kMesh), ElementsAre(1, 3));
}

TEST(Region, ReadsNodeNumbersFromTextAndNumpyFiles) {
  const TestFolder folder;
  folder.Write("nodes.txt", "3\n0\n");
  WriteNpyIntegers(folder.Path() / "nodes.npy", MatrixXi64::Constant(1, 1, 2));
  EXPECT_THAT(SelectNodes(Read("nodes_file: nodes.txt", folder.Path()), kMesh), ElementsAre(0, 3));
  EXPECT_THAT(SelectNodes(Read("nodes_file: nodes.npy", folder.Path()), kMesh), ElementsAre(2));
  folder.Write("row.txt", "3 0\n");
  EXPECT_THAT(SelectNodes(Read("nodes_file: row.txt", folder.Path()), kMesh), ElementsAre(0, 3));
  folder.Write("half.txt", "0.5\n");
  EXPECT_THAT(ErrorOf([&] { Read("nodes_file: half.txt", folder.Path()); }),
              HasSubstr("got 0.5 as a node number"));
}

// pandas writes its index in front of each row.
TEST(Region, RefusesNodeNumbersBesideAnotherColumn) {
  const TestFolder folder;
  folder.Write("index.csv", ",node\n0,3\n1,1\n");
  folder.Write("one.csv", "index,node\n0,3\n");
  for (const std::string file : {"index.csv", "one.csv"})
    EXPECT_THAT(ErrorOf([&] { Read("nodes_file: " + file, folder.Path()); }),
                AllOf(HasSubstr(file), HasSubstr("has 2 columns")));
}

// Lists the nodes of `file` on the plane x = 0 and compares them with the half-space beyond it.
void ExpectTheFaceOf(const Eigen::Matrix3Xd& file, bool is_sheet, const TetMesh& mesh) {
  NodeRegion listed;
  for (int i = 0; i < file.cols(); ++i)
    if (file(0, i) == 0) listed.nodes.push_back(i);
  listed.file_nodes = static_cast<int>(file.cols());
  listed.is_sheet = is_sheet;
  const Region half_space = Read("half_space: {point: [0, 0, 0], normal: [-1, 0, 0]}");
  const std::vector<int> nodes = SelectNodes({"clamp", listed}, mesh);
  EXPECT_EQ(nodes, SelectNodes(half_space, mesh));
  EXPECT_GT(nodes.size(), listed.nodes.size());
}

TEST(Region, OfListedNodesHasTheNodesThatTheMeshAddsBetweenThem) {
  const TetMesh linear = BoxMesh({0, 0, 0}, {2, 1, 1}, {2, 2, 2});
  ExpectTheFaceOf(linear.nodes, false, ToQuadratic(linear));
  TriMesh sheet;
  sheet.vertices = (Eigen::Matrix3Xd(3, 4) << 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0).finished();
  sheet.triangles = (Eigen::Matrix3Xi(3, 2) << 0, 1, 1, 3, 2, 2).finished();
  const TetMesh thick = ThickenToTets(sheet, 0.1, 2);
  ExpectTheFaceOf(sheet.vertices, true, thick);
  ExpectTheFaceOf(sheet.vertices, true, ToQuadratic(thick));
}

TEST(Region, OfListedNodesHasNoOtherNodesWhereTheFileNumbersThemAll) {
  const TetMesh mesh = ToQuadratic(BoxMesh({0, 0, 0}, {1, 1, 1}, {1, 1, 1}));
  NodeRegion corners{{0, 2, 4, 6}};
  EXPECT_EQ(SelectNodes({"clamp", corners}, mesh), corners.nodes);
  corners.file_nodes = static_cast<int>(mesh.NodeCount());
  EXPECT_EQ(SelectNodes({"clamp", corners}, mesh), corners.nodes);
}

TEST(Region, ReportsMistakes) {
  EXPECT_THAT(ErrorOf([] { Read("name: clamp"); }), HasSubstr("describes 0 shapes"));
  EXPECT_THAT(ErrorOf([] { Read("{nodes: [1], sphere: {center: [0, 0, 0], radius: 1 m}}"); }),
              HasSubstr("describes 2 shapes"));
  EXPECT_THAT(ErrorOf([] { Read("box: {min: [1 m, 0, 0], max: [0, 1 m, 1 m]}"); }),
              HasSubstr("box.max: lies below min"));
  EXPECT_THAT(ErrorOf([] { SelectNodes(Read("nodes: [4]"), kMesh); }),
              HasSubstr("region \"clamp\" lists node 4; the reference shape has 4 nodes"));
  EXPECT_THAT(
      ErrorOf([] { SelectNodes(Read("sphere: {center: [9 m, 0, 0], radius: 1 mm}"), kMesh); }),
      HasSubstr("region \"clamp\" (sphere around (9, 0, 0) m of radius 0.001 m) holds no "
                "node"));
}

TEST(Region, IsWrittenAsItIsRead) {
  for (const std::string yaml :
       {"box: {min: [0.1 mm, -1 mm, -1 mm], max: [1 cm, 1 mm, 0.3 m]}",
        "sphere: {center: [0.02 m, 0, 0.01 m], radius: 10 mm}",
        "half_space: {point: [15 mm, 0, 0], normal: [1, 2, 3]}", "nodes: [3, 1]"}) {
    const Region region = Read(yaml);
    const std::string written = FormatRegion(region);
    EXPECT_EQ(FormatRegion(Read(written)), written);
    EXPECT_EQ(DescribeRegion(Read(written)), DescribeRegion(region));
  }
}

TEST(Similarity, ScalesThenRotatesThenMoves) {
  const Config config = Config::Parse(
      "{scale: 2, axis: [0, 0, 3], angle: 90 deg, translation: [1 m, 0, 0]}", "recording.yaml");
  const Similarity similarity = ReadSimilarity(config, 1e-3);
  const Eigen::Matrix3Xd moved = similarity * Eigen::Matrix3Xd(Eigen::Vector3d(500, 0, 250));
  // cos 90° is zero only up to rounding.
  EXPECT_LT((moved.col(0) - Eigen::Vector3d(1, 1, 0.5)).norm(), 1e-15);
}

TEST(Similarity, RemovesTheRoundingOfAMatrixAndRefusesOneThatIsNoRotation) {
  const auto read = [](const std::string& matrix) {
    return ReadSimilarity(Config::Parse("matrix: " + matrix, "recording.yaml"), 1).rotation;
  };
  const Eigen::Matrix3d rotation = read("[0.70711, -0.70711, 0, 0.70711, 0.70711, 0, 0, 0, 1]");
  EXPECT_LT((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_NEAR(rotation(1, 0), M_SQRT1_2, 1e-14);
  EXPECT_THAT(ErrorOf([&] { read("[1, 0, 0, 0, 1, 0, 0, 0, -1]"); }),
              HasSubstr("matrix: is not a rotation"));
  EXPECT_THAT(ErrorOf([&] { read("[2, 0, 0, 0, 2, 0, 0, 0, 2]"); }), HasSubstr("not a rotation"));
  EXPECT_THAT(ErrorOf([&] { read("[1, 0]"); }), HasSubstr("got 2 numbers; expected nine"));
}

}  // namespace
}  // namespace lacuna
