#include "scan/components.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lacuna {
namespace {

using ::testing::ElementsAre;

TEST(Components, OfASurfaceAreOrderedByArea) {
  TriMesh surface;
  surface.vertices.resize(3, 7);
  surface.vertices << 0, 1, 0, 8, 10, 8, 5,  //
      0, 0, 1, 0, 0, 2, 5,                   //
      0, 0, 0, 0, 0, 0, 0;
  surface.triangles.resize(3, 2);
  surface.triangles << 0, 3, 1, 4, 2, 5;
  EXPECT_THAT(ComponentsOfSurface(surface), ElementsAre(1, 1, 1, 0, 0, 0, -1));
}

// The larger vertex numbers of the first triangle enclose those of the second.
TEST(Components, OfEqualAreaAreOrderedByTheirFirstVertex) {
  TriMesh surface;
  surface.vertices.resize(3, 6);
  surface.vertices << 0, 1, 8, 9, 8, 0,  //
      0, 0, 0, 0, 1, 1,                  //
      0, 0, 0, 0, 0, 0;
  surface.triangles.resize(3, 2);
  surface.triangles << 0, 2, 1, 3, 5, 4;
  EXPECT_THAT(ComponentsOfSurface(surface), ElementsAre(0, 0, 1, 1, 1, 0));
}

TEST(Components, OfAnEquallyLargeCloudAreOrderedByTheirFirstPoint) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 40);
  for (int i = 0; i < 40; ++i) points(0, i) = 0.001 * (i / 2) + (i % 2 == 0 ? 1.0 : 0.0);
  const Eigen::VectorXi component = ComponentsOfCloud(points);
  for (int i = 0; i < 40; ++i) EXPECT_EQ(component[i], i % 2) << i;
}

}  // namespace
}  // namespace lacuna
