// A body's surface at rest, divided into patches of about equal area: the places at which scans
// measure it.
#ifndef LACUNA_GEOMETRY_SURFACE_PATCHES_H_
#define LACUNA_GEOMETRY_SURFACE_PATCHES_H_

#include <Eigen/Core>

#include "geometry/tri_mesh.h"

namespace lacuna {

// A point x of the surface with normal n belongs to the patch c for which
//   |x − x_c|² + w² |n − n_c|²
// is least, w the radius of a disc of a patch's area. The second term keeps the two sides of an
// edge, or of a thin sheet, apart. Patches are fixed to the material and to no mesh: a finer mesh
// of the same shape has the same.
struct SurfacePatches {
  Eigen::Matrix3Xd place;   // 3 × patches, m, at rest
  Eigen::Matrix3Xd normal;  // 3 × patches, unit length
  double width = 0;         // w, m

  int Count() const { return static_cast<int>(place.cols()); }
  int PatchOf(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;
};

// `count` patches of the closed surface, by farthest-point sampling of random points (a fixed
// seed) and a few of Lloyd's iterations. The same for any number of threads.
SurfacePatches DivideSurface(const TriMesh& surface, int count);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_SURFACE_PATCHES_H_
