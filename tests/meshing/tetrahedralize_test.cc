#include "meshing/tetrahedralize.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <random>

#include "core/memory_limit.h"
#include "support/shapes.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

struct Body {
  const char* name;
  TriMesh surface;
};
std::vector<Body> Bodies() {
  return {{"sphere", Icosphere(0.1, 3)},
          {"box", BoxSurface({0.2, 0.03, 0.04}, {14, 2, 3})},
          {"organic", OrganicSurface(4)}};
}

TEST(MeshTetrahedra, FillsTheSurfaceExactly) {
  for (const auto& [name, surface] : Bodies()) {
    const MeshResult result = MeshTetrahedra(surface, {});
    ASSERT_TRUE(result.IsUsable()) << name << ": " << result.message;
    const double volume = EnclosedVolume(surface);
    EXPECT_GT(result.quality.volume.min, 0) << name;
    // Sums of thousands of volumes, rounded.
    EXPECT_NEAR(result.quality.total_volume, volume, 1e-11 * volume) << name;
    EXPECT_EQ(result.quality.tets, result.mesh.TetCount());
    EXPECT_EQ(result.quality.nodes, result.mesh.NodeCount());
  }
}

TEST(MeshTetrahedra, KeepsTheSurfaceOnRequest) {
  for (const auto& [name, surface] : Bodies()) {
    const MeshResult result = MeshTetrahedra(surface, {.preserve_surface = true});
    ASSERT_TRUE(result.IsUsable()) << name << ": " << result.message;
    const Eigen::Index n = surface.vertices.cols();
    const double size = BoundingBoxDiagonal(surface.vertices);
    // Scaling there and back rounds once or twice.
    EXPECT_LT((result.mesh.nodes.leftCols(n) - surface.vertices).cwiseAbs().maxCoeff(),
              1e-15 * size)
        << name;
    const BoundarySurface boundary = ExtractBoundary(result.mesh);
    EXPECT_EQ(boundary.surface.triangles.cols(), surface.triangles.cols()) << name;
    EXPECT_EQ(boundary.node, Eigen::VectorXi::LinSpaced(n, 0, static_cast<int>(n) - 1)) << name;
  }
}

TEST(MeshTetrahedra, ObeysTheRadiusEdgeBound) {
  const TriMesh sphere = Icosphere(0.1, 3), box = BoxSurface({0.2, 0.03, 0.04}, {14, 2, 3});
  for (const double bound : {2.0, 1.6}) {
    for (const bool preserve : {true, false}) {
      for (const TriMesh& surface : {sphere, box}) {
        const MeshResult result =
            MeshTetrahedra(surface, {.radius_edge_ratio = bound, .preserve_surface = preserve});
        ASSERT_TRUE(result.IsUsable()) << result.message;
        // TetGen's last smoothing may move a tetrahedron in a thousand back over the bound.
        EXPECT_LE(result.quality.above_ratio, result.mesh.TetCount() / 1000);
        EXPECT_LE(result.quality.radius_edge_ratio.max, 1.1 * bound);
        EXPECT_TRUE(result.notes.empty());
      }
    }
  }
}

TEST(MeshTetrahedra, AStricterRatioGivesBetterShapedTetrahedra) {
  const TriMesh surface = OrganicSurface(4);
  const auto worst = [&](double bound) {
    const Eigen::VectorXd ratios =
        MeshTetrahedra(surface, {.radius_edge_ratio = bound, .min_dihedral_angle = 0})
            .quality.radius_edge_ratios;
    return (ratios.array() > 1.5).cast<double>().mean();
  };
  EXPECT_LT(worst(1.5), 0.2 * worst(3));
}

TEST(MeshTetrahedra, RefusesWhatDoesNotFitIntoMemory) {
  const TriMesh surface = Icosphere(0.1, 3);
  SetMemoryLimit(MemoryInUse() + 100'000'000);
  EXPECT_TRUE(MeshTetrahedra(surface, {.max_volume = 1e-6}).IsUsable());
  EXPECT_THROW(MeshTetrahedra(surface, {.max_volume = 1e-9}), OutOfMemory);
  SetMemoryLimit(0);
}

// Lets the process grow by so many bytes and no more while the object lives: then allocations fail.
class AddressSpaceLimit {
 public:
  explicit AddressSpaceLimit(rlim_t growth) {
    getrlimit(RLIMIT_AS, &before_);
    rlim_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    rlimit limit = before_;
    limit.rlim_cur = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + growth;
    setrlimit(RLIMIT_AS, &limit);
  }
  ~AddressSpaceLimit() { setrlimit(RLIMIT_AS, &before_); }
  AddressSpaceLimit(const AddressSpaceLimit&) = delete;
  AddressSpaceLimit& operator=(const AddressSpaceLimit&) = delete;

 private:
  rlimit before_{};
};

// A failed mesh is a property of the surface and the options, which a search keeps for good. That
// an allocation fails depends on the machine.
TEST(MeshTetrahedra, AFailedAllocationIsNoFailureOfTheMesh) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer reserves its address space in advance and ends the program instead";
#endif
  const TriMesh box = BoxSurface({1, 1, 1}, {2, 2, 2});
  const auto mesh = [&] {
    const AddressSpaceLimit limit(50'000'000);
    // A million tetrahedra take some 800 MB.
    return MeshTetrahedra(box, {.max_volume = 1e-6, .preserve_surface = false});
  };
  EXPECT_THAT(mesh, ThrowsMessage<OutOfMemory>(HasSubstr("TetGen ran out of memory")));
}

TEST(MeshTetrahedra, ObeysTheLargestVolume) {
  for (const auto& [name, surface] : Bodies()) {
    const double bound = EnclosedVolume(surface) / 3000;
    const MeshResult result =
        MeshTetrahedra(surface, {.max_volume = bound, .preserve_surface = false});
    ASSERT_TRUE(result.IsUsable()) << name << ": " << result.message;
    EXPECT_GE(result.mesh.TetCount(), 3000) << name;
    // TetGen's last smoothing may grow a tetrahedron in a thousand by a third.
    EXPECT_LE(result.quality.above_volume, result.mesh.TetCount() / 1000) << name;
    EXPECT_LE(result.quality.volume.max, 1.4 * bound) << name;
  }
}

TEST(MeshTetrahedra, NotesAPreservedSurfaceThatIsTooCoarse) {
  const TriMesh box = BoxSurface({0.2, 0.03, 0.04}, {14, 2, 3});
  const MeshResult result = MeshTetrahedra(box, {.max_volume = 1e-8});
  ASSERT_TRUE(result.IsUsable());
  EXPECT_GT(result.quality.above_volume, 0);
  ASSERT_FALSE(result.notes.empty());
  EXPECT_THAT(result.notes[0], HasSubstr("are larger than 1e-08 m^3"));
}

TEST(MeshTetrahedra, NotesASurfaceThatIsMuchFinerThanTheLargestVolume) {
  const TriMesh box = BoxSurface({0.2, 0.03, 0.04}, {80, 12, 16});
  const MeshResult coarse = MeshTetrahedra(box, {.max_volume = 1e-5});
  ASSERT_TRUE(coarse.IsUsable());
  ASSERT_EQ(coarse.notes.size(), 1u);
  EXPECT_THAT(coarse.notes[0], HasSubstr("would need about 24"));
  const MeshResult fitting = MeshTetrahedra(box, {.max_volume = 1e-8});
  ASSERT_TRUE(fitting.IsUsable());
  EXPECT_TRUE(fitting.notes.empty()) << fitting.notes[0];
}

// Twelve triangles make no tetrahedra small.
TEST(MeshTetrahedra, NotesAThinBody) {
  const MeshResult thin = MeshTetrahedra(BoxSurface({0.08, 0.022, 0.001}, {1, 1, 1}),
                                         {.max_volume = 6e-8, .preserve_surface = false});
  ASSERT_TRUE(thin.IsUsable());
  ASSERT_EQ(thin.notes.size(), 1u);
  EXPECT_THAT(thin.notes[0], HasSubstr("because the body is thin"));
}

TEST(MeshTetrahedra, ASmallerVolumeMakesMoreTetrahedra) {
  const TriMesh box = BoxSurface({0.2, 0.03, 0.04}, {14, 2, 3});
  const auto count = [&](double volume) {
    return MeshTetrahedra(box, {.max_volume = volume, .preserve_surface = false}).mesh.TetCount();
  };
  EXPECT_GT(count(1e-8), 2 * count(3e-8));
}

TEST(MeshTetrahedra, DoesNotDependOnUnitsOrPlace) {
  TriMesh surface = OrganicSurface(3);
  const MeshResult metres = MeshTetrahedra(surface, {.max_volume = 0.01});
  // A power of two scales without rounding: a body of micrometres is meshed like one of metres.
  const double scale = std::ldexp(1.0, -20);
  surface.vertices *= scale;
  const MeshResult small = MeshTetrahedra(surface, {.max_volume = 0.01 * scale * scale * scale});
  ASSERT_TRUE(small.IsUsable()) << small.message;
  EXPECT_EQ(small.mesh.tets, metres.mesh.tets);
  EXPECT_EQ(small.mesh.nodes, scale * metres.mesh.nodes);
}

TEST(MeshTetrahedra, IsReproducibleBitByBit) {
  const TriMesh surface = OrganicSurface(4);
  const MeshResult first = MeshTetrahedra(surface, {.max_volume = 0.002});
  MeshTetrahedra(Icosphere(1, 2), {});
  const MeshResult second = MeshTetrahedra(surface, {.max_volume = 0.002});
  EXPECT_EQ(first.mesh.nodes, second.mesh.nodes);
  EXPECT_EQ(first.mesh.tets, second.mesh.tets);
}

TEST(MeshTetrahedra, GivesQuadraticMeshes) {
  const TriMesh sphere = Icosphere(0.1, 2);
  const MeshResult linear = MeshTetrahedra(sphere, {}),
                   quadratic = MeshTetrahedra(sphere, {.order = 2});
  ASSERT_TRUE(quadratic.IsUsable());
  EXPECT_EQ(quadratic.mesh.Order(), 2);
  EXPECT_EQ(quadratic.mesh.tets.topRows(4), linear.mesh.tets);
  EXPECT_EQ(quadratic.quality.nodes, quadratic.mesh.NodeCount());
}

TEST(MeshTetrahedra, MeshesSeparateBodies) {
  const TriMesh one = Icosphere(1, 2);
  TriMesh two{Eigen::Matrix3Xd(3, 2 * one.vertices.cols()),
              Eigen::Matrix3Xi(3, 2 * one.triangles.cols())};
  two.vertices << one.vertices, one.vertices.colwise() + Eigen::Vector3d(3, 0, 0);
  two.triangles << one.triangles, one.triangles.array() + static_cast<int>(one.vertices.cols());
  const MeshResult result = MeshTetrahedra(two, {});
  ASSERT_TRUE(result.IsUsable()) << result.message;
  EXPECT_NEAR(result.quality.total_volume, 2 * EnclosedVolume(one), 1e-11);
}

void ExpectRefused(const TriMesh& surface, const std::string& cause) {
  ::testing::internal::CaptureStdout();
  const MeshResult result = MeshTetrahedra(surface, {});
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_FALSE(result.IsUsable());
  EXPECT_EQ(result.status, MeshStatus::kFaultySurface);
  EXPECT_THAT(result.message, HasSubstr(cause));
  EXPECT_EQ(result.mesh.TetCount(), 0);
}

TEST(MeshTetrahedra, ReportsTheFaultOfASurfaceThatBoundsNoVolume) {
  const TriMesh sphere = Icosphere(1, 2);
  ExpectRefused({}, "no triangles");

  TriMesh open = sphere;
  open.triangles.conservativeResize(3, sphere.triangles.cols() - 1);
  ExpectRefused(open, "1 hole");

  TriMesh inside_out = sphere;
  inside_out.triangles.row(0).swap(inside_out.triangles.row(1));
  ExpectRefused(inside_out, "inside out");

  // A spike pushed through the far side.
  TriMesh crossing = sphere;
  crossing.vertices.col(7) *= -1.5;
  ExpectRefused(crossing, "self-intersection");
}

TEST(MeshTetrahedra, RefusesVerticesOutsideTheSurface) {
  TriMesh sphere = Icosphere(1, 2);
  sphere.vertices.conservativeResize(3, sphere.vertices.cols() + 1);
  sphere.vertices.rightCols(1).setZero();
  ExpectRefused(sphere, "1 vertices of the surface belong to no triangle");
}

TEST(MeshTetrahedra, ReportsVerticesTooCloseForTetGen) {
  TriMesh plate = BoxSurface({1, 1, 1e-10}, {2, 2, 1});
  const MeshResult result = MeshTetrahedra(plate, {});
  EXPECT_EQ(result.status, MeshStatus::kTooSmallFeature);
  EXPECT_THAT(result.message, HasSubstr("are 1e-10 m apart"));
}

TEST(MeshTetrahedra, RefusesTooManyTetrahedra) {
  TetOptions options;
  options.max_volume = 1e-9;
  const MeshResult result = MeshTetrahedra(BoxSurface({1, 1, 1}, {2, 2, 2}), options);
  EXPECT_EQ(result.status, MeshStatus::kTooManyTets);
  EXPECT_THAT(result.message, HasSubstr("max_volume requires at least 1000 million"));
}

TEST(MeshTetrahedra, RefusesCavities) {
  const TriMesh outer = Icosphere(1, 2);
  TriMesh inner = Icosphere(0.5, 2);
  inner.triangles.row(0).swap(inner.triangles.row(1));
  TriMesh shell{Eigen::Matrix3Xd(3, 2 * outer.vertices.cols()),
                Eigen::Matrix3Xi(3, 2 * outer.triangles.cols())};
  shell.vertices << outer.vertices, inner.vertices;
  shell.triangles << outer.triangles,
      inner.triangles.array() + static_cast<int>(outer.vertices.cols());
  ExpectRefused(shell, "inside out");
  ExpectRefused(shell, "give its tetrahedra (`from: tet_mesh`)");
}

// Stars with random spikes: sharp, thin and irregular, but valid surfaces.
TEST(MeshTetrahedra, GivesAMeshOrAReasonOnSpikyBodies) {
  std::mt19937_64 generator(3);
  for (int trial = 0; trial < 12; ++trial) {
    TriMesh star = Icosphere(1, 2);
    for (auto v : star.vertices.colwise()) {
      v *= std::exp(2 * static_cast<double>(generator() >> 11) * 0x1p-53);
    }
    const MeshResult result =
        MeshTetrahedra(star, {.preserve_surface = trial % 2 == 0, .max_added_nodes = 20000});
    if (result.IsUsable()) {
      const double volume = EnclosedVolume(star);
      EXPECT_NEAR(result.quality.total_volume, volume, 1e-10 * volume);
    } else {
      EXPECT_NE(result.message, "");
    }
  }
}

// Two boxes with a tiny gap: a valid surface at the limits of double precision.
class NarrowGap : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Widths, NarrowGap, ::testing::Values(1e-5, 1e-8, 1e-11, 1e-14));

TEST_P(NarrowGap, IsMeshedOrReported) {
  const TriMesh box = BoxSurface({1, 1, 1}, {2, 2, 2});
  TriMesh two{Eigen::Matrix3Xd(3, 2 * box.vertices.cols()),
              Eigen::Matrix3Xi(3, 2 * box.triangles.cols())};
  two.vertices << box.vertices, box.vertices.colwise() + Eigen::Vector3d(1 + GetParam(), 0.3, 0.2);
  two.triangles << box.triangles, box.triangles.array() + static_cast<int>(box.vertices.cols());
  ::testing::internal::CaptureStdout();
  const MeshResult result = MeshTetrahedra(two, {.max_added_nodes = 20000});
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  if (result.IsUsable()) {
    EXPECT_NEAR(result.quality.total_volume, 2, 1e-10);
  } else {
    EXPECT_NE(result.message, "");
    EXPECT_NE(result.status, MeshStatus::kNotRun);
    EXPECT_EQ(result.mesh.TetCount(), 0);
  }
}

TEST(MeshTetrahedra, ChecksTheRangesOfItsOptions) {
  EXPECT_DEATH(MeshTetrahedra({}, {.min_dihedral_angle = -0.1}), "min_dihedral_angle");
  EXPECT_DEATH(MeshTetrahedra({}, {.max_added_nodes = -1}), "max_added_nodes");
}

}  // namespace
}  // namespace lacuna
