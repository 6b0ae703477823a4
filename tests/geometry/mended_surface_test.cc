#include "geometry/mended_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "geometry/surface_check.h"
#include "support/shapes.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TriMesh WholeBox() { return BoxSurface({7, 2, 2}, {7, 2, 2}); }

// Each triangle with vertices of its own.
TriMesh Split(const TriMesh& mesh) {
  TriMesh split{Eigen::Matrix3Xd(3, 3 * mesh.triangles.cols()),
                Eigen::Matrix3Xi(3, mesh.triangles.cols())};
  for (int i = 0; i < split.triangles.size(); ++i) {
    split.vertices.col(i) = mesh.vertices.col(mesh.triangles.reshaped()[i]);
    split.triangles.reshaped()[i] = i;
  }
  return split;
}

void Turn(TriMesh* mesh, const std::vector<int>& triangles) {
  for (const int t : triangles) std::swap(mesh->triangles(1, t), mesh->triangles(2, t));
}

void ExpectTheBox(const MendedSurface& mended) {
  const SurfaceReport report = CheckSurface(mended.mesh);
  EXPECT_TRUE(report.BoundsVolume()) << DescribeFaults(report);
  EXPECT_EQ(report.triangles, WholeBox().triangles.cols());
  EXPECT_NEAR(report.volume, 28, 1e-4);  // single precision where there is noise
}

TEST(MendSurface, LeavesASoundSurfaceAsItIs) {
  for (const TriMesh& sound : {WholeBox(), OrganicSurface(2), FlatSheet(1, 1, 3, 2),
                               Together(WholeBox(), Icosphere(0.1, 1))}) {
    const MendedSurface mended = MendSurface(sound);
    EXPECT_EQ(mended.mesh.vertices, sound.vertices);
    EXPECT_EQ(mended.mesh.triangles, sound.triangles);
    EXPECT_EQ(mended.vertex_in_file.size(), sound.vertices.cols());
    EXPECT_THAT(mended.notes, IsEmpty());
  }
}

TEST(MendSurface, MergesVerticesAtTheSamePlace) {
  TriMesh split = Split(WholeBox());
  for (Eigen::Index i = 0; i < split.vertices.size(); i += 2)
    if (double& x = split.vertices.reshaped()[i]; x == 0) x = -0.0;  // the same place as 0
  const MendedSurface mended = MendSurface(split);
  ExpectTheBox(mended);
  EXPECT_EQ(mended.mesh.vertices.cols(), WholeBox().vertices.cols());
  EXPECT_EQ(Eigen::Matrix3Xd(split.vertices(Eigen::all, mended.vertex_in_file)),
            mended.mesh.vertices);
  EXPECT_THAT(mended.notes, ElementsAre(HasSubstr("vertices with others at the same place")));
  EXPECT_THAT(MendSurface(split, /*is_stl=*/true).notes, IsEmpty());
}

TEST(MendSurface, MergesOpenEdgesOfStlWithinItsRounding) {
  TriMesh split = Split(WholeBox());
  std::mt19937 generator(1);
  for (double& coordinate : split.vertices.reshaped())
    coordinate += 1e-12 * static_cast<double>(generator() % 1'000'000);  // up to 1e-6, of 7
  EXPECT_FALSE(CheckSurface(MendSurface(split).mesh).IsClosed());
  const MendedSurface mended = MendSurface(split, /*is_stl=*/true);
  ExpectTheBox(mended);
  EXPECT_THAT(mended.notes, ElementsAre(HasSubstr("at open edges with others that are nearer")));
}

TEST(MendSurface, DropsRepeatedAndDegenerateTrianglesAndUnusedVertices) {
  const TriMesh box = WholeBox();
  TriMesh given{Eigen::Matrix3Xd(3, box.vertices.cols() + 1),
                Eigen::Matrix3Xi(3, box.triangles.cols() + 3)};
  given.vertices << Eigen::Vector3d(500, 500, 500), box.vertices;
  given.triangles << Eigen::Vector3i(1, 1, 2), box.triangles.array() + 1,
      box.triangles.col(3).array() + 1, box.triangles.col(5).reverse().array() + 1;
  const MendedSurface mended = MendSurface(given);
  EXPECT_EQ(mended.mesh.vertices, box.vertices);
  EXPECT_EQ(mended.mesh.triangles, box.triangles);
  EXPECT_EQ(mended.vertex_in_file[0], 1);
  EXPECT_THAT(mended.notes, ElementsAre("dropped 1 triangles with a repeated corner",
                                        "dropped 2 triangles that repeat an earlier one",
                                        "dropped 1 vertices that no triangle uses"));
}

TEST(MendSurface, TurnsTrianglesLikeTheirNeighboursAndClosedSurfacesOutward) {
  TriMesh box = WholeBox();
  Turn(&box, {0, 5, 17});
  const MendedSurface mended = MendSurface(box);
  ExpectTheBox(mended);
  EXPECT_THAT(mended.notes, ElementsAre(HasSubstr("turned 3 of ")));

  TriMesh inward = WholeBox();
  inward.triangles.row(1).swap(inward.triangles.row(2));
  const MendedSurface turned = MendSurface(inward);
  ExpectTheBox(turned);
  EXPECT_THAT(turned.notes, ElementsAre(HasSubstr("turned 1 of 1 components")));

  // Of an open surface, most triangles decide.
  const TriMesh sheet = FlatSheet(1, 1, 3, 3);
  TriMesh mixed = sheet;
  Turn(&mixed, {0, 1, 2, 8});
  EXPECT_EQ(MendSurface(mixed).mesh.triangles, sheet.triangles);
}

// Far from the origin the rounding of coordinates decides about the sign of a small volume.
TEST(MendSurface, AgreesWithCheckSurfaceAboutWhatIsInsideOut) {
  constexpr double kFar = 0x1p20;  // neighbouring doubles differ by 2^-32 there
  for (const bool is_thick : {false, true}) {
    TriMesh slab = BoxSurface({1, 1, is_thick ? 0x1p-24 : 0x1p-30}, {1, 1, 1});
    slab.vertices.row(2).array() += kFar;
    slab.triangles.row(1).swap(slab.triangles.row(2));
    const SurfaceReport given = CheckSurface(slab, false);
    EXPECT_EQ(given.flat_components.size(), is_thick ? 0u : 1u);
    EXPECT_EQ(given.inside_out_components.size(), is_thick ? 1u : 0u);
    const MendedSurface mended = MendSurface(slab);
    EXPECT_EQ(mended.notes.size(), is_thick ? 1u : 0u);
    EXPECT_TRUE(CheckSurface(mended.mesh, false).inside_out_components.empty());
  }
}

// A wall that was turned would make two bodies of one with a cavity.
TEST(MendSurface, LeavesTheWallOfACavityAndOneSidedSurfaces) {
  TriMesh wall = Icosphere(0.3, 1);
  wall.vertices.colwise() += Eigen::Vector3d(3, 1, 1);
  wall.triangles.row(1).swap(wall.triangles.row(2));
  const TriMesh hollow = Together(WholeBox(), wall);
  const MendedSurface mended = MendSurface(hollow);
  EXPECT_EQ(mended.mesh.triangles, hollow.triangles);
  EXPECT_THAT(mended.notes, IsEmpty());

  // A ring of squares whose last one is joined upside down.
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  constexpr int kSquares = 6;
  for (int i = 0; i < kSquares; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSquares, twist = angle / 2;
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
    const Eigen::Vector3d across =
        std::cos(twist) * Eigen::Vector3d::UnitZ() + std::sin(twist) * out;
    vertices.push_back(3 * out - across);
    vertices.push_back(3 * out + across);
    const int a = 2 * i, b = a + 1;
    const int c = i + 1 < kSquares ? a + 2 : 1, d = i + 1 < kSquares ? b + 2 : 0;
    triangles.push_back({a, c, b});
    triangles.push_back({b, c, d});
  }
  const TriMesh strip = MeshOf(vertices, triangles);
  EXPECT_FALSE(CheckSurface(strip).IsOriented());
  EXPECT_EQ(MendSurface(strip).mesh.triangles, strip.triangles);
}

}  // namespace
}  // namespace lacuna
