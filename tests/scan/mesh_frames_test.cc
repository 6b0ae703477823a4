#include "scan/mesh_frames.h"

#include <gtest/gtest.h>

#include "geometry/mesh_io.h"
#include "scan/recording_fixture.h"
#include "support/shapes.h"

namespace lacuna {
namespace {

TEST_F(RecordingTest, LoadsMeshesWithTheirTrianglesAndNormals) {
  const TriMesh box = BoxSurface({100, 50, 20}, {2, 2, 2});
  WriteTriMesh(folder_.Path() / "s0.ply", box);
  const Recording recording =
      Load(Yaml("  {kind: mesh, files: [s0.ply], transform: {translation: [1 m, 0, 0]}}\n"));
  const Frame frame = LoadFrame(recording, 0);
  EXPECT_EQ(frame.triangles, box.triangles);
  EXPECT_NEAR(frame.cloud.points.row(0).maxCoeff(), 1.1, 1e-12);
  ASSERT_TRUE(frame.cloud.HasNormals());
  const Eigen::Vector3d center(1.05, 0.025, 0.01);
  EXPECT_GT((frame.cloud.points.colwise() - center)
                .cwiseProduct(frame.cloud.normals)
                .colwise()
                .sum()
                .minCoeff(),
            0);
}

TEST_F(RecordingTest, KeepsTheLargestComponentOfAMesh) {
  TriMesh both = BoxSurface({100, 50, 20}, {2, 2, 2});
  const Eigen::Index object_vertices = both.vertices.cols(), object = both.triangles.cols();
  TriMesh debris = BoxSurface({4, 4, 4}, {3, 3, 3});
  debris.vertices.colwise() += Eigen::Vector3d(200, 0, 0);
  both.vertices.conservativeResize(3, object_vertices + debris.vertices.cols());
  both.vertices.rightCols(debris.vertices.cols()) = debris.vertices;
  both.triangles.conservativeResize(3, object + debris.triangles.cols());
  both.triangles.rightCols(debris.triangles.cols()) =
      debris.triangles.array() + static_cast<int>(object_vertices);
  WriteTriMesh(folder_.Path() / "s0.ply", both);
  const Frame frame =
      LoadFrame(Load(Yaml("  {kind: mesh, files: [s0.ply], keep_largest: true}\n")), 0);
  EXPECT_EQ(frame.triangles.cols(), object);
  EXPECT_EQ(frame.cloud.Size(), object_vertices);
  EXPECT_EQ(frame.separate_count, debris.vertices.cols());
}

}  // namespace
}  // namespace lacuna
