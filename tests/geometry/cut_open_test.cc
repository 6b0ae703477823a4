#include "geometry/cut_open.h"

#include <gtest/gtest.h>

#include "support/box_mesh.h"

namespace lacuna {
namespace {

// A box of 4 × 2 × 3 m³ in cells of 1 m³.
TetMesh Box(int order) {
  return BoxMesh(Eigen::Vector3d::Zero(), Eigen::Vector3d(4, 2, 3), {4, 2, 3}, order);
}

TEST(CutOpenTest, APlaneBetweenCellsExposesItsSection) {
  for (const int order : {1, 2}) {
    const CutMesh cut = CutOpen(Box(order), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(2, 0, 0));
    // The section is 2 m × 3 m; three quarters of the sides and one end of the surface are removed.
    // Areas are sums of a few dozen exact numbers.
    EXPECT_NEAR(TriangleAreas(cut.inner).sum(), 6, 1e-12);
    EXPECT_NEAR(TriangleAreas(cut.skin).sum(), 6 + 2 * (2 + 3) * 1, 1e-12);
    TriMesh closed = cut.skin;
    closed.triangles.conservativeResize(3, cut.skin.triangles.cols() + cut.inner.triangles.cols());
    closed.triangles.rightCols(cut.inner.triangles.cols()) = cut.inner.triangles;
    EXPECT_NEAR(EnclosedVolume(closed), 6, 1e-12) << "both parts are oriented outward";
    const Eigen::Matrix3Xd normals = TriangleNormals(cut.inner);
    EXPECT_LT((normals.colwise() - Eigen::Vector3d::UnitX()).norm(), 1e-12);
  }
}

TEST(CutOpenTest, APlaneBesideTheMeshKeepsAllOrNothing) {
  const Eigen::Vector3d beside(5, 0, 0);
  const CutMesh whole = CutOpen(Box(1), beside, Eigen::Vector3d::UnitX());
  EXPECT_EQ(whole.inner.triangles.cols(), 0);
  EXPECT_EQ(whole.skin.triangles.cols(), ExtractBoundary(Box(1)).surface.triangles.cols());
  const CutMesh nothing = CutOpen(Box(1), beside, -Eigen::Vector3d::UnitX());
  EXPECT_EQ(nothing.inner.triangles.cols() + nothing.skin.triangles.cols(), 0);
}

}  // namespace
}  // namespace lacuna
