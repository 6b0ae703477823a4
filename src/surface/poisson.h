// The iso-surface of the screened Poisson equation.
#ifndef LACUNA_SURFACE_POISSON_H_
#define LACUNA_SURFACE_POISSON_H_

#include "geometry/point_cloud.h"
#include "geometry/tri_mesh.h"

namespace lacuna {

struct PoissonOptions {
  int depth = 8;                // levels of the octree; raising it by one costs four times as much
  double samples_per_node = 3;  // raising it smooths
  double point_weight = 4;      // raising it follows the points more closely
};

// The octree covers a cube of this many times the longest side of the points' bounding box.
inline constexpr double kPoissonCubeScale = 1.2;

// The iso-surface as it comes: it may have several components, holes where it leaves the cube, and
// slivers. Oriented as the points are, that is outward. The points need normals. One thread, so
// that the result is the same in each run; PCL computes in single precision, relative to the
// points' own bounding box. Empty when PCL finds no iso-surface.
TriMesh PoissonIsoSurface(const PointCloud& oriented, const PoissonOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SURFACE_POISSON_H_
