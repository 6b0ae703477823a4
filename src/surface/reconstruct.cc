#include "surface/reconstruct.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "core/median.h"
#include "geometry/nearest.h"
#include "surface/poisson.h"
#include "surface/repair.h"

namespace lacuna {
namespace {

constexpr int kMinDepth = 3, kMaxDepth = 12;
constexpr Eigen::Index kFewestPoints = 10;

void RefuseUnusable(const PointCloud& cloud) {
  if (cloud.Size() < kFewestPoints) {
    throw InputError(
        fmt::format("a surface requires at least {} points, got {}", kFewestPoints, cloud.Size()));
  }
  if (!cloud.HasNormals()) throw InputError("a surface requires points with normals");
  for (Eigen::Index i = 0; i < cloud.Size(); ++i) {
    if (!cloud.points.col(i).allFinite() || !cloud.normals.col(i).allFinite()) {
      throw InputError(fmt::format("point {} of {} is not finite", i + 1, cloud.Size()));
    }
  }
  if (!(BoundingBoxDiagonal(cloud.points) > 0)) throw InputError("all points coincide");
}

int DepthForSpacing(const PointCloud& cloud, double spacing) {
  const double cube = kPoissonCubeScale * BoundingBox(cloud.points).sizes().maxCoeff();
  return std::clamp(static_cast<int>(std::ceil(std::log2(cube / spacing))), kMinDepth, kMaxDepth);
}

// Refuses an edge length that would exhaust the memory. The usual cause is a wrong length unit.
void RefuseTooManyTriangles(const TriMesh& surface, double edge_length) {
  constexpr double kMost = 4e6;
  const double area = TriangleAreas(surface).sum();
  const double triangles = area / (std::sqrt(3) / 4 * edge_length * edge_length);
  if (triangles <= kMost) return;
  throw InputError(fmt::format(
      "edges of {:g} m would divide a surface of {:.3g} m² into about {:.2g} triangles, more than "
      "{:g}; choose a longer edge_length, or check the recording's length_unit",
      edge_length, area, triangles, kMost));
}

}  // namespace

double TypicalSpacing(const Eigen::Matrix3Xd& points) {
  const int k = static_cast<int>(std::min<Eigen::Index>(8, points.cols() - 1));
  // The nearest neighbour of each point is the point itself, hence k + 1.
  const Eigen::VectorXd reach = PointSearch(points).Nearest(points, k + 1).distance.row(k);
  return std::sqrt(std::numbers::pi / k) * Median({reach.begin(), reach.end()});
}

Surface ReconstructSurface(const PointCloud& oriented, const SurfaceOptions& options) {
  RefuseUnusable(oriented);
  Surface surface;
  surface.spacing = TypicalSpacing(oriented.points);
  if (!(surface.spacing > 0)) throw InputError("most points coincide with other points");
  surface.depth = options.depth > 0 ? std::clamp(options.depth, kMinDepth, kMaxDepth)
                                    : DepthForSpacing(oriented, surface.spacing);

  const TriMesh mesh =
      PoissonIsoSurface(oriented, {surface.depth, options.samples_per_node, options.point_weight});
  RepairedSurface repaired = RepairSurface(mesh);
  surface.notes = std::move(repaired.notes);
  if (repaired.mesh.triangles.cols() == 0) {
    surface.status = SurfaceStatus::kEmpty;
    surface.message =
        "Poisson reconstruction found no surface; check that the normals point outward everywhere";
    return surface;
  }
  const double edge = options.edge_length > 0 ? options.edge_length : 2 * surface.spacing;
  RefuseTooManyTriangles(repaired.mesh, edge);
  repaired = RepairSurface(RemeshIsotropic(repaired.mesh, edge));
  surface.notes.insert(surface.notes.end(), repaired.notes.begin(), repaired.notes.end());
  surface.mesh = std::move(repaired.mesh);
  surface.report = CheckSurface(surface.mesh);
  surface.message = DescribeFaults(surface.report);
  surface.status = surface.message.empty() ? SurfaceStatus::kUsable : SurfaceStatus::kFaulty;
  return surface;
}

}  // namespace lacuna
