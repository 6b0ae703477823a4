#include "scan/mesh_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "geometry/mesh_io.h"
#include "scan/recording_fixture.h"
#include "support/shapes.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

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

// Programs write vertices once for each face. In tracked frames the first of them is the row of
// all.
TEST_F(RecordingTest, MergesVerticesOfMeshesAndKeepsTheRowsOfTrackedOnes) {
  const TriMesh box = BoxSurface({100, 50, 20}, {2, 2, 2});
  TriMesh split{box.vertices(Eigen::all, box.triangles.reshaped()), box.triangles};
  for (int i = 0; i < split.triangles.size(); ++i) split.triangles.reshaped()[i] = i;
  WriteTriMesh(folder_.Path() / "s0.ply", split);
  WriteTriMesh(folder_.Path() / "s1.ply", split);
  const Recording scan = Load(Yaml("  {kind: mesh, files: s*.ply, rate: 1 Hz}\n"));
  EXPECT_THAT(scan.warnings, ElementsAre(HasSubstr("s0.ply: merged ")));
  EXPECT_EQ(LoadFrame(scan, 1).row_count, box.vertices.cols());
  const Frame frame =
      LoadFrame(Load(Yaml("  {kind: mesh, files: s*.ply, rate: 1 Hz, tracked: true}\n")), 1);
  EXPECT_EQ(frame.cloud.Size(), box.vertices.cols());
  EXPECT_EQ(frame.row_count, split.vertices.cols());
  EXPECT_EQ(frame.dropped_count, 0);
  for (Eigen::Index i = 0; i < frame.cloud.Size(); ++i)
    EXPECT_TRUE(frame.cloud.points.col(i).isApprox(1e-3 * split.vertices.col(frame.source_row[i])));
}

TEST_F(RecordingTest, RefusesATrackedMeshWhoseVerticesAreNumberedAnew) {
  TriMesh mesh = OrganicSurface(1);
  WriteTriMesh(folder_.Path() / "s0.ply", mesh);
  std::swap(mesh.triangles(0, 0), mesh.triangles(2, 0));  // the same triangle, turned
  WriteTriMesh(folder_.Path() / "s1.ply", mesh);
  mesh.vertices = mesh.vertices.rowwise().reverse().eval();
  mesh.triangles = static_cast<int>(mesh.vertices.cols()) - 1 - mesh.triangles.array();
  WriteTriMesh(folder_.Path() / "s2.ply", mesh);
  const Recording tracked =
      Load(Yaml("  {kind: mesh, files: s*.ply, rate: 1 Hz, tracked: true}\n"));
  EXPECT_NO_THROW(LoadFrame(tracked, 1));
  EXPECT_THAT([&] { LoadFrame(tracked, 2); },
              testing::ThrowsMessage<InputError>(
                  HasSubstr("triangles join other vertices than in frame 0")));
  EXPECT_NO_THROW(LoadFrame(Load(Yaml("  {kind: mesh, files: s*.ply, rate: 1 Hz}\n")), 2));
}

}  // namespace
}  // namespace lacuna
