#include "scan/region.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/npy.h"
#include "scan/similarity.h"
#include "scan/test_files.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const Eigen::Matrix3Xd kNodes =
    (Eigen::Matrix3Xd(3, 4) << 0, 0.01, 0.02, 0.03, 0, 0, 0, 0, 0, 0, 0.01, 0.01).finished();

Region Read(const std::string& yaml, const std::filesystem::path& folder = {}) {
  const Config config = Config::Parse(yaml, "recording.yaml");
  const Region region = ReadRegion(config, folder, "clamp");
  config.RefuseUnknownKeys();
  return region;
}

TEST(Region, SelectsTheNodesInsideEachShape) {
  const Region box = Read("box: {min: [0, -1 mm, -1 mm], max: [1 cm, 1 mm, 1 mm]}");
  EXPECT_THAT(SelectNodes(box, kNodes), ElementsAre(0, 1));  // the border belongs to the region
  const Region sphere = Read("sphere: {center: [0.02 m, 0, 0.01 m], radius: 10 mm}");
  EXPECT_THAT(SelectNodes(sphere, kNodes), ElementsAre(2, 3));
  const Region half_space = Read("half_space: {point: [15 mm, 0, 0], normal: [2, 0, 0]}");
  EXPECT_THAT(SelectNodes(half_space, kNodes), ElementsAre(2, 3));
  EXPECT_THAT(SelectNodes(Read("nodes: [3, 1, 3]"), kNodes), ElementsAre(1, 3));
}

TEST(Region, ReadsNodeNumbersFromTextAndNumpyFiles) {
  const TestFolder folder;
  folder.Write("nodes.txt", "3\n0\n");
  WriteNpyIntegers(folder.Path() / "nodes.npy", MatrixXi64::Constant(1, 1, 2));
  EXPECT_THAT(SelectNodes(Read("nodes_file: nodes.txt", folder.Path()), kNodes), ElementsAre(0, 3));
  EXPECT_THAT(SelectNodes(Read("nodes_file: nodes.npy", folder.Path()), kNodes), ElementsAre(2));
  folder.Write("half.txt", "0.5\n");
  EXPECT_THAT(ErrorOf([&] { Read("nodes_file: half.txt", folder.Path()); }),
              HasSubstr("got 0.5 as a node number"));
}

TEST(Region, ReportsMistakes) {
  EXPECT_THAT(ErrorOf([] { Read("name: clamp"); }), HasSubstr("describes 0 shapes"));
  EXPECT_THAT(ErrorOf([] { Read("{nodes: [1], sphere: {center: [0, 0, 0], radius: 1 m}}"); }),
              HasSubstr("describes 2 shapes"));
  EXPECT_THAT(ErrorOf([] { Read("box: {min: [1 m, 0, 0], max: [0, 1 m, 1 m]}"); }),
              HasSubstr("box.max: lies below min"));
  EXPECT_THAT(ErrorOf([] { SelectNodes(Read("nodes: [4]"), kNodes); }),
              HasSubstr("region \"clamp\" lists node 4; the reference shape has 4 nodes"));
  EXPECT_THAT(
      ErrorOf([] { SelectNodes(Read("sphere: {center: [9 m, 0, 0], radius: 1 mm}"), kNodes); }),
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
