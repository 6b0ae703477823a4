#include "scan/depth_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/test_files.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

DepthImage Slope() {
  DepthImage depth(5, 7);
  for (int v = 0; v < 5; ++v) {
    for (int u = 0; u < 7; ++u) depth(v, u) = 0.5 + 0.001 * u + 0.01 * v;
  }
  depth(2, 3) = 0;
  return depth;
}

TEST(DepthImage, ComesBackFromPngToHalfACount) {
  const TestFolder folder;
  WriteDepthPng(folder.Path() / "a.png", Slope(), 1e-4);
  const DepthImage depth = ReadDepthPng(folder.Path() / "a.png", 1e-4);
  ASSERT_EQ(depth.rows(), 5);
  ASSERT_EQ(depth.cols(), 7);
  EXPECT_LE((depth - Slope()).cwiseAbs().maxCoeff(), 0.5e-4 + 1e-12);
  EXPECT_EQ(depth(2, 3), 0);
}

TEST(DepthImage, PointsProjectBackToTheirPixels) {
  Camera camera;
  camera.intrinsics = {600, 620, 3.1, 2.2};
  camera.world_from_camera = Eigen::Translation3d(1, 2, 3) *
                             Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized());
  const DepthImage depth = Slope();
  const PointCloud cloud = BackProject(depth, camera, 0, 10);
  ASSERT_EQ(cloud.Size(), 34);  // one pixel is empty
  int i = 0;
  for (int v = 0; v < 5; ++v) {
    for (int u = 0; u < 7; ++u) {
      if (depth(v, u) == 0) continue;
      const Eigen::Vector3d p = camera.world_from_camera.inverse() * cloud.points.col(i++);
      EXPECT_NEAR(600 * p.x() / p.z() + 3.1, u, 1e-9);
      EXPECT_NEAR(620 * p.y() / p.z() + 2.2, v, 1e-9);
      EXPECT_NEAR(p.z(), depth(v, u), 1e-12);
    }
  }
  EXPECT_EQ(BackProject(depth, camera, 0.5045, 0.5205).Size(), 2 + 7 + 1);
}

TEST(DepthImage, RefusesTruncatedAndOtherPngs) {
  const TestFolder folder;
  WriteDepthPng(folder.Path() / "whole.png", Slope(), 1e-4);
  const std::string whole = FileContent(folder.Path() / "whole.png");
  for (const size_t size : {whole.size() - 14, whole.size() / 2, size_t{20}, size_t{4}}) {
    const auto file = folder.Write("short.png", whole.substr(0, size));
    EXPECT_THAT(ErrorOf([&] { ReadDepthPng(file, 1e-4); }),
                HasSubstr("short.png: is not a whole 16-bit PNG"));
  }
  // 1 × 1 pixel of 8 bits, grey.
  const std::string eight_bits(
      "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\x08\0\0\0\0\x3a\x7e\x9b\x55\0\0\0\nIDATx\x9c"
      "c`\0\0\0\2\0\1\x48\xaf\xa4\x71\0\0\0\0IEND\xae\x42\x60\x82",
      67);
  EXPECT_THAT(ErrorOf([&] { ReadDepthPng(folder.Write("eight.png", eight_bits), 1e-4); }),
              HasSubstr("one channel of 16 bits"));
  EXPECT_THAT(ErrorOf([&] { ReadDepthPng(folder.Write("junk.png", "hello"), 1e-4); }),
              HasSubstr("junk.png: is not a whole 16-bit PNG"));
}

}  // namespace
}  // namespace lacuna
