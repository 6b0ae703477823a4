// Reconstruction of the surface of one frame from its points: Poisson reconstruction, repair and
// remeshing.
#ifndef LACUNA_SURFACE_RECONSTRUCT_H_
#define LACUNA_SURFACE_RECONSTRUCT_H_

#include <string>
#include <vector>

#include "geometry/point_cloud.h"
#include "geometry/surface_check.h"
#include "geometry/tri_mesh.h"

namespace lacuna {

struct SurfaceOptions {
  // Levels of the Poisson octree, 3..12. For 0 the finest cells get a width between half the point
  // spacing and the spacing. Each further level resolves finer detail, and more of the noise, in
  // four times the time.
  int depth = 0;
  // Number of points that a finest cell should hold. Raising it (to 15 or 20) smooths noisy scans.
  double samples_per_node = 3;
  // Weight of passing through the points relative to matching their normals. Raising it makes the
  // surface follow the points, and their noise, more closely; 0 is unscreened reconstruction.
  double point_weight = 4;
  // Edge length of the result, m; 0 means twice the point spacing. Raising it makes all later
  // stages faster and smooths out detail.
  double edge_length = 0;
};

enum class SurfaceStatus {
  kNotRun,
  kUsable,
  kFaulty,  // the surface lacks required properties; `message` describes the faults
  kEmpty,   // no surface was found
};

struct Surface {
  TriMesh mesh;
  SurfaceReport report;            // of `mesh`
  double spacing = 0;              // TypicalSpacing of the points, m
  int depth = 0;                   // levels of the octree that was used
  std::vector<std::string> notes;  // one entry for each repair
  SurfaceStatus status = SurfaceStatus::kNotRun;
  std::string message = "not run";

  bool IsUsable() const { return status == SurfaceStatus::kUsable; }
};

// Reconstructs the closed surface around points with outward normals: the iso-surface of the
// screened Poisson equation (surface/poisson.h) is reduced to its largest component, repaired
// (surface/repair.h) and remeshed isotropically. A usable result bounds a volume. The same points
// give the same surface to the last bit. Throws InputError for fewer than 10 points, points without
// normals, values that are not finite, points most or all of which coincide, and an edge length
// that would give more than four million triangles.
Surface ReconstructSurface(const PointCloud& oriented, const SurfaceOptions& options);

// The distance, m, between neighbours if the points were spread evenly over the same surface: the
// median over the points of √(π/k) times the distance to the k-th nearest neighbour, k = 8 (or n −
// 1 if that is less). `points`: 3 × n, m, n ≥ 2.
double TypicalSpacing(const Eigen::Matrix3Xd& points);

}  // namespace lacuna

#endif  // LACUNA_SURFACE_RECONSTRUCT_H_
