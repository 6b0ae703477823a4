// From the points of one frame to its surface: Poisson reconstruction, repair, even triangles.
#ifndef LACUNA_SURFACE_RECONSTRUCT_H_
#define LACUNA_SURFACE_RECONSTRUCT_H_

#include <string>
#include <vector>

#include "geometry/point_cloud.h"
#include "geometry/surface_check.h"
#include "geometry/tri_mesh.h"

namespace lacuna {

struct SurfaceOptions {
  // A closed surface around all points; or an open one that ends where the points end.
  bool closed = true;
  // Levels of the Poisson octree, 3..12; 0 makes its finest cells as wide as the spacing of the
  // points, or down to half. Raising it keeps finer detail, and more of the noise, at four times
  // the cost.
  int depth = 0;
  // Points that a finest cell should hold. Raising it (to 15 or 20) smooths noisy scans.
  double samples_per_node = 3;
  // Weight of passing through the points against matching their normals. Raising it follows the
  // points, and their noise, more closely; 0 is unscreened Poisson reconstruction.
  double point_weight = 4;
  // Length of the edges of the result, m; 0 takes twice the spacing of the points. Raising it
  // makes everything after faster and rounds off detail.
  double edge_length = 0;
  // Passes of isotropic remeshing; 0 leaves the triangles of the iso-surface as they are. Raising
  // it evens the triangles further.
  int remesh_iterations = 4;
  // Open surfaces end this far from the nearest point, m; 0 takes three times the spacing.
  // Raising it bridges wider gaps and leaves a wider fringe.
  double trim_distance = 0;
  // Holes of an open surface up to this perimeter are filled, m; 0 takes 20 times the spacing.
  double max_hole_perimeter = 0;
};

enum class SurfaceStatus {
  kNotRun,
  kUsable,
  kFaulty,  // there is a surface, but it does not meet what was asked; `message` says where
  kEmpty,   // there is none
};

struct Surface {
  TriMesh mesh;
  SurfaceReport report;            // of `mesh`
  double spacing = 0;              // typical distance of neighbouring points, m
  int depth = 0;                   // of the octree that was used
  std::vector<std::string> notes;  // what was repaired, never silent
  SurfaceStatus status = SurfaceStatus::kNotRun;
  std::string message = "not run";

  bool IsUsable() const { return status == SurfaceStatus::kUsable; }
};

// The surface through points with outward normals, as an iso-surface of the screened Poisson
// equation (Kazhdan & Hoppe 2013, by PCL), with its largest component kept, slivers removed, holes
// filled, self-intersections removed and CGAL's isotropic remeshing. A usable closed result bounds
// a volume; a usable open one is manifold, oriented and free of self-intersections. The same
// points give the same surface, bit by bit. Throws InputError for fewer than 10 points, points
// without normals, values that are not finite, and points all in one place.
Surface ReconstructSurface(const PointCloud& oriented, const SurfaceOptions& options);

// The distance of neighbouring points that an even spread over the same surface would have: the
// median of √(π/k) times the distance of the k-th nearest neighbour, k = 8. Needs two points.
double TypicalSpacing(const Eigen::Matrix3Xd& points);

}  // namespace lacuna

#endif  // LACUNA_SURFACE_RECONSTRUCT_H_
