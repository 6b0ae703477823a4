// A body's surface at rest, divided into patches of about equal area: the places at which scans
// measure it.
#ifndef LACUNA_GEOMETRY_SURFACE_PATCHES_H_
#define LACUNA_GEOMETRY_SURFACE_PATCHES_H_

#include <Eigen/Core>

#include "geometry/tri_mesh.h"

namespace lacuna {

// A point x of the surface with normal n belongs to the patch c for which
//   |x − x_c|² + w² |n − n_c|²
// is least, where w is the radius of a disc of a patch's area. The second term keeps the two sides
// of an edge, or of a thin sheet, apart. Patches are fixed to the material rather than to a mesh: a
// finer mesh of the same shape has the same patches.
struct SurfacePatches {
  Eigen::Matrix3Xd place;   // 3 × patches, m, at rest
  Eigen::Matrix3Xd normal;  // 3 × patches, unit length
  double width = 0;         // w, m

  int Count() const { return static_cast<int>(place.cols()); }
  // The number of the patch to which a point at rest (m, finite) with a unit normal belongs; the
  // first of several equally near patches.
  int PatchOf(const Eigen::Vector3d& point, const Eigen::Vector3d& at_normal) const;
};

// Divides the closed surface into `count` > 0 patches (CHECK), by farthest-point sampling of random
// points (with a fixed seed) and a few iterations of Lloyd's algorithm. The result does not depend
// on the number of threads. CHECKs that the surface has an area.
SurfacePatches DivideSurface(const TriMesh& surface, int count);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_SURFACE_PATCHES_H_
