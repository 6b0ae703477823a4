// Screened Poisson surface reconstruction with PCL.
//
// The implicit function χ minimises ∫ ‖∇χ − V‖² dx + α Σ_i χ(x_i)², where V is the smoothed field
// of the normals, the x_i are the points and α is their weight (M. Kazhdan and H. Hoppe, "Screened
// Poisson surface reconstruction", ACM TOG 32, 2013). The surface is an iso-surface of χ.
#ifndef LACUNA_SURFACE_POISSON_H_
#define LACUNA_SURFACE_POISSON_H_

#include "geometry/point_cloud.h"
#include "geometry/tri_mesh.h"

namespace lacuna {

struct PoissonOptions {
  int depth = 8;                // levels of the octree; each further level takes four times as long
  double samples_per_node = 3;  // points per finest cell; raising it smooths the surface
  double point_weight = 4;      // α; raising it makes the surface follow the points more closely
};

// The octree covers a cube whose side is this multiple of the longest side of the bounding box.
inline constexpr double kPoissonCubeScale = 1.2;

// Returns the iso-surface, in m, without any repair: it may have several components, holes where it
// leaves the cube, and slivers. It is oriented like the normals of the points, that is outward. PCL
// runs on one thread, so that the result is the same in each run, and computes in single precision,
// relative to the bounding box of the points. The points must have normals and must not all
// coincide (CHECK). The result is empty if PCL finds no surface or fails; a failure is logged as a
// warning.
TriMesh PoissonIsoSurface(const PointCloud& oriented, const PoissonOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SURFACE_POISSON_H_
