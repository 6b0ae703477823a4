// Screened Poisson surface reconstruction (M. Kazhdan and H. Hoppe, ACM TOG 32, 2013), by PCL.
#ifndef LACUNA_SURFACE_POISSON_H_
#define LACUNA_SURFACE_POISSON_H_

#include "geometry/point_cloud.h"
#include "geometry/tri_mesh.h"

namespace lacuna {

struct PoissonOptions {
  int depth = 8;                // levels of the octree; each further level takes four times as long
  double samples_per_node = 3;  // points per finest cell; raising it smooths the surface
  double point_weight = 4;      // raising it makes the surface follow the points more closely
};

// The octree covers a cube whose side is this multiple of the longest side of the bounding box.
inline constexpr double kPoissonCubeScale = 1.2;

// Returns the iso-surface without any repair: it may have several components, holes where it leaves
// the cube, and slivers. It is oriented like the normals of the points, that is outward. Runs on
// one thread, so that the result is the same in each run; PCL computes in single precision,
// relative to the points' bounding box. The points need normals. The result is empty if PCL finds
// no surface.
TriMesh PoissonIsoSurface(const PointCloud& oriented, const PoissonOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SURFACE_POISSON_H_
