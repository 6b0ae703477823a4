#include "scan/point_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "scan/delimited_table.h"
#include "scan/test_files.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

const Eigen::Matrix3Xd kPoints =
    (Eigen::Matrix3Xd(3, 4) << 0.1, 4, 7, -1, 2, 5, 8, 0, 3, 6, 9.25, 1e-3).finished();

std::string PlyHeader(const std::string& format, const std::string& type, int count) {
  return "ply\nformat " + format + " 1.0\ncomment from a test\nelement vertex " +
         std::to_string(count) + "\nproperty " + type + " x\nproperty " + type + " y\nproperty " +
         type + " z\nend_header\n";
}

template <typename T>
std::string Binary(bool big_endian) {
  std::string bytes;
  for (const double value : kPoints.reshaped()) {
    const T stored = static_cast<T>(value);
    std::string one(sizeof(T), '\0');
    std::memcpy(one.data(), &stored, sizeof(T));
    if (big_endian) std::reverse(one.begin(), one.end());
    bytes += one;
  }
  return bytes;
}

std::string Text() {
  std::ostringstream text;
  text.precision(17);
  for (int i = 0; i < 4; ++i) {
    text << kPoints(0, i) << ' ' << kPoints(1, i) << ' ' << kPoints(2, i) << '\n';
  }
  return text.str();
}

std::string PcdHeader(const std::string& data, int count) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\n"
         "TYPE F F F\nCOUNT 1 1 1\nWIDTH " +
         std::to_string(count) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
         std::to_string(count) + "\nDATA " + data + "\n";
}

// PCL writes such an element, and takes the size of its image for that of the cloud.
TEST(PointFile, ACameraInAPlyFileDoesNotChangeTheNumberOfPoints) {
  const TestFolder folder;
  for (const char* viewport : {"1 2", "640 480"}) {
    std::string content = PlyHeader("ascii", "float", 4);
    content.insert(content.find("end_header"),
                   "element camera 1\nproperty int viewportx\nproperty int viewporty\n");
    const auto file = folder.Write("a.ply", content + Text() + viewport + "\n");
    EXPECT_EQ(ReadPointFile(file, {}).Size(), 4) << viewport;
  }
}

TEST(PointFile, ReadsPlyOfEveryKindToItsOwnPrecision) {
  const TestFolder folder;
  const std::vector<std::pair<std::string, double>> contents = {
      {PlyHeader("ascii", "double", 4) + Text(), 0},
      {PlyHeader("binary_little_endian", "double", 4) + Binary<double>(false), 0},
      {PlyHeader("binary_big_endian", "double", 4) + Binary<double>(true), 0},
      // Single precision rounds 9.25 and less to 2⁻²⁴ of 8.
      {PlyHeader("binary_little_endian", "float", 4) + Binary<float>(false), 5e-7}};
  for (const auto& [content, tolerance] : contents) {
    const PointCloud cloud = ReadPointFile(folder.Write("a.ply", content), {});
    ASSERT_EQ(cloud.Size(), 4);
    EXPECT_LE((cloud.points - kPoints).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_FALSE(cloud.HasNormals());
  }
}

TEST(PointFile, ReadsPcdInTextAndBinary) {
  const TestFolder folder;
  for (const std::string& content :
       {PcdHeader("ascii", 4) + Text(), PcdHeader("binary", 4) + Binary<float>(false)}) {
    const PointCloud cloud = ReadPointFile(folder.Write("a.pcd", content), {});
    ASSERT_EQ(cloud.Size(), 4);
    EXPECT_LE((cloud.points - kPoints).cwiseAbs().maxCoeff(), 5e-7);  // single precision
  }
}

TEST(PointFile, ReadsColumnsByNameAndByNumber) {
  const TestFolder folder;
  const auto named = folder.Write("a.csv", "id;z_mm;y_mm;x_mm\n1;3;2;1\n2;6;5;4\n");
  PointColumns columns;
  columns.position = {"x_mm", "y_mm", "z_mm"};
  EXPECT_EQ(ReadPointFile(named, columns).points.col(1), Eigen::Vector3d(4, 5, 6));
  columns.position = {"4", "3", "2"};
  EXPECT_EQ(ReadPointFile(named, columns).points.col(0), Eigen::Vector3d(1, 2, 3));
  columns.position = {"x_mm", "y_mm", "depth"};
  EXPECT_THAT(ErrorOf([&] { ReadPointFile(named, columns); }),
              HasSubstr("has no column \"depth\"; its columns are id, z_mm, y_mm, x_mm"));
}

TEST(PointFile, ReadsXyzWithAndWithoutNormals) {
  const TestFolder folder;
  const auto bare = folder.Write("a.xyz", "# scanner\n1 2 3\n4\t5   6\n");
  EXPECT_EQ(ReadPointFile(bare, {}).points.col(1), Eigen::Vector3d(4, 5, 6));
  const auto normals = folder.Write("b.xyz", "1 2 3 0 0 1\n4 5 6 0 1 0\n");
  const PointCloud cloud = ReadPointFile(normals, {});
  ASSERT_TRUE(cloud.HasNormals());
  EXPECT_EQ(cloud.normals.col(1), Eigen::Vector3d::UnitY());
}

TEST(PointFile, RefusesToTakeColoursForNormals) {
  const TestFolder folder;
  const auto file = folder.Write("a.xyz", "1 2 3 255 0 0\n4 5 6 0 255 0\n");
  EXPECT_THAT(ErrorOf([&] { ReadPointFile(file, {}); }), HasSubstr("has 6 columns and no header"));
}

TEST(PointFile, KeepsRowsThatAreNotNumbersAsNan) {
  const TestFolder folder;
  const auto file = folder.Write("a.csv", "x,y,z\n1,2,3\nnan,NaN,\n4,5,6\n");
  const PointCloud cloud = ReadPointFile(file, {});
  ASSERT_EQ(cloud.Size(), 3);
  EXPECT_TRUE(std::isnan(cloud.points(2, 1)));
  EXPECT_EQ(cloud.points.col(2), Eigen::Vector3d(4, 5, 6));
}

TEST(PointFile, WritesWhatItReads) {
  const TestFolder folder;
  PointCloud cloud{kPoints, Eigen::Matrix3Xd(3, 0)};
  WritePointFile(folder.Path() / "a.ply", cloud);
  EXPECT_EQ(ReadPointFile(folder.Path() / "a.ply", {}).points, kPoints);
  cloud.normals = Eigen::Matrix3Xd::Zero(3, 4);
  cloud.normals.row(1).setOnes();
  WritePointFile(folder.Path() / "b.ply", cloud);
  EXPECT_EQ(ReadPointFile(folder.Path() / "b.ply", {}).normals, cloud.normals);
}

// The first bytes of the points may look like lines of a header.
TEST(PointFile, ReadsPcdWhosePointsLookLikeAHeader) {
  const TestFolder folder;
  std::string body = "WIDTH 1200000000\nHEIGHT 1\nPOINTS 1200000000\nDATA binary\n";
  while (body.size() % 12 != 0) body += '\n';
  const int count = static_cast<int>(body.size() / 12);
  const PointCloud cloud =
      ReadPointFile(folder.Write("a.pcd", PcdHeader("binary", count) + body), {});
  ASSERT_EQ(cloud.Size(), count);
  float first = 0;
  std::memcpy(&first, body.data(), sizeof(first));
  EXPECT_EQ(cloud.points(0, 0), first);
}

TEST(PointFile, RefusesTruncatedAndMalformedFiles) {
  const TestFolder folder;
  const std::string ply = PlyHeader("binary_little_endian", "float", 4) + Binary<float>(false);
  const std::string pcd = PcdHeader("binary", 4) + Binary<float>(false);
  const std::vector<std::tuple<std::string, std::string, std::string>> cases = {
      {"short.ply", ply.substr(0, ply.size() - 7), "is truncated or malformed"},
      {"less.ply", PlyHeader("ascii", "float", 5) + Text(), "is truncated or malformed"},
      {"header.ply", ply.substr(0, 60), "ends within its header"},
      {"junk.ply", "hello\n", "is not a PLY file"},
      {"word.ply", PlyHeader("ascii", "float", 1) + "1 two 3\n", "word.ply:9:3: got \"two\""},
      {"short.pcd", pcd.substr(0, pcd.size() - 5), "is truncated or malformed"},
      {"less.pcd", PcdHeader("ascii", 5) + Text(), "is truncated or malformed"},
      {"word.pcd", PcdHeader("ascii", 1) + "1 2 q\n", "got \"q\""},
      {"junk.pcd", "hello\n", "is not a PCD file"},
      {"twice.pcd", "POINTS 4\n" + PcdHeader("ascii", 4) + Text(), "has a second line POINTS"},
      {"huge.pcd", PcdHeader("binary", 2000000000) + "x", "huge.pcd"},
      {"empty.ply", "", "is empty"},
      {"empty.pcd", "", "is empty"},
      {"empty.csv", "", "is empty"},
      {"header.csv", "x,y,z\n", "holds no row of numbers"},
      {"ragged.csv", "x,y,z\n1,2,3\n4,5\n", "ragged.csv:3:1: has 2 entries"},
      {"word.csv", "x,y,z\n1,2,3\n4,five,6\n", "word.csv:3:3: got \"five\"; expected a number"}};
  for (const auto& [name, content, expected] : cases) {
    const auto file = folder.Write(name, content);
    const std::string message = ErrorOf([&] { ReadPointFile(file, {}); });
    EXPECT_THAT(message, HasSubstr(expected)) << name;
    EXPECT_THAT(message, HasSubstr(name));
  }
  EXPECT_THAT(ErrorOf([&] { ReadPointFile(folder.Path() / "absent.ply", {}); }),
              HasSubstr("absent.ply: cannot be read"));
}

}  // namespace
}  // namespace lacuna
