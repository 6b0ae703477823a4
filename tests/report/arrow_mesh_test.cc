#include "report/arrow_mesh.h"

#include <gtest/gtest.h>

namespace lacuna {
namespace {

TEST(ArrowMeshTest, EachArrowReachesFromItsStartToItsEnd) {
  Eigen::Matrix3Xd from(3, 3), along(3, 3);
  from << 0, 5, 9,  //
      0, 0, 0,      //
      0, 1, 0;
  along << 1, 0, 0,  //
      0, 0, 0,       //
      0, -0.02, 0;
  constexpr double kRadius = 0.01;
  const TriMesh mesh = ArrowMesh(from, along, kRadius);
  ASSERT_EQ(mesh.vertices.cols(), 3 * kArrowVertices);
  const auto arrow = [&](int k) {
    return BoundingBox(mesh.vertices.middleCols(k * kArrowVertices, kArrowVertices));
  };
  // Sums of a start and a length of 1 m.
  EXPECT_NEAR(arrow(0).min().x(), 0, 1e-15);
  EXPECT_NEAR(arrow(0).max().x(), 1, 1e-15);
  EXPECT_LE(arrow(0).max().y(), 3 * kRadius + 1e-15);
  // Shorter than a head: a smaller head.
  EXPECT_NEAR(arrow(1).max().z(), 1, 1e-15);
  EXPECT_NEAR(arrow(1).min().z(), 0.98, 1e-15);
  EXPECT_LT(arrow(1).sizes().x(), 3 * kRadius);
  EXPECT_LT(arrow(2).diagonal().norm(), 1e-15) << "nothing to show";
}

TEST(ArrowMeshTest, IsSeenFromOutside) {
  const TriMesh mesh = ArrowMesh(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.3, 0.4, 0.5), 0.01);
  EXPECT_GT(EnclosedVolume(mesh), 0);
}

}  // namespace
}  // namespace lacuna
