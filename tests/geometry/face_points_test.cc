#include "geometry/face_points.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "support/box_mesh.h"

namespace lacuna {
namespace {

// A box whose nodes are moved by a quadratic map, which quadratic faces follow exactly.
struct Warped {
  explicit Warped(int order)
      : mesh(BoxMesh({0, 0, 0}, {2, 1, 1}, {2, 1, 1}, order)), boundary(ExtractBoundary(mesh)) {
    nodes = mesh.nodes;
    for (Eigen::Index n = 0; n < nodes.cols(); ++n) nodes.col(n) = Map(mesh.nodes.col(n));
  }
  static Eigen::Vector3d Map(const Eigen::Vector3d& x) {
    return {x.x() + 0.1 * x.y() * x.z(), x.y() - 0.2 * x.x() * x.x(), x.z() + 0.1 * x.x() * x.y()};
  }
  static Eigen::Matrix3d Gradient(const Eigen::Vector3d& x) {
    Eigen::Matrix3d gradient;
    gradient << 1, 0.1 * x.z(), 0.1 * x.y(), -0.4 * x.x(), 1, 0, 0.1 * x.y(), 0.1 * x.x(), 1;
    return gradient;
  }
  TetMesh mesh;
  BoundarySurface boundary;
  Eigen::Matrix3Xd nodes;
};

TEST(FacePoints, FollowTheCurvedFaceOfAQuadraticMesh) {
  const Warped warped(2);
  const TriMesh& surface = warped.boundary.surface;
  const Eigen::Matrix3Xd flat_normals = TriangleNormals(surface);
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3d at(0.2, 0.5, 0.3);
    const FacePoint point = PlaceOnFace(warped.boundary, t, at);
    EXPECT_NEAR(point.weight.sum(), 1, 1e-14);
    const FaceGeometry rest = Evaluate(point, warped.boundary, warped.mesh.nodes);
    Eigen::Vector3d expected = Eigen::Vector3d::Zero();
    for (int a = 0; a < 3; ++a) expected += at[a] * surface.vertices.col(surface.triangles(a, t));
    EXPECT_LT((rest.position - expected).norm(), 1e-14);
    EXPECT_LT((rest.normal - flat_normals.col(t)).norm(), 1e-13);
    // The point lies where the map takes it, with the normal given by Nanson's formula.
    const FaceGeometry now = Evaluate(point, warped.boundary, warped.nodes);
    EXPECT_LT((now.position - Warped::Map(expected)).norm(), 1e-14);
    const Eigen::Vector3d carried =
        Warped::Gradient(expected).inverse().transpose() * flat_normals.col(t);
    EXPECT_LT((now.normal - carried.normalized()).norm(), 1e-13);
  }
}

TEST(FacePoints, LieInTheTrianglesOfALinearMesh) {
  const Warped warped(1);
  const TriMesh surface = BoundaryAt(warped.boundary, warped.nodes);
  const Eigen::Matrix3Xd normals = TriangleNormals(surface);
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3d at(0.2, 0.5, 0.3);
    const FacePoint point = PlaceOnFace(warped.boundary, t, at);
    EXPECT_EQ(point.count, 3);
    const FaceGeometry now = Evaluate(point, warped.boundary, warped.nodes);
    const Eigen::Matrix3d corners = surface.vertices(Eigen::all, surface.triangles.col(t));
    EXPECT_LT((now.position - corners * at).norm(), 1e-14);
    EXPECT_LT((now.normal - normals.col(t)).norm(), 1e-13);
  }
}

}  // namespace
}  // namespace lacuna
