// Repair and isotropic remeshing of triangle meshes with CGAL.
#ifndef LACUNA_SURFACE_REPAIR_H_
#define LACUNA_SURFACE_REPAIR_H_

#include <string>
#include <vector>

#include "geometry/tri_mesh.h"

namespace lacuna {

struct RepairedSurface {
  TriMesh mesh;
  std::vector<std::string> notes;  // one entry for each change
};

// Merges coincident vertices, removes repeated and degenerate triangles, splits non-manifold edges
// and vertices, orients the triangles consistently (a closed surface outward), keeps the component
// with the largest area only, flips or collapses slivers (triangles with an angle above 160° or an
// edge ratio above 4, which may shift the surface by a fraction of the mean edge length), fills all
// holes, and cuts out triangles that cross others. Faults that cannot be repaired remain, so the
// caller should check the result with CheckSurface. `mesh` may be any set of triangles with indices
// in range and finite vertices.
RepairedSurface RepairSurface(const TriMesh& mesh);

// Splits, collapses and flips edges and moves vertices along the surface, in four passes, until
// edges are about `edge_length` (m, positive: CHECK) long (M. Botsch and L. Kobbelt, "A remeshing
// approach to multiresolution modeling", SGP 2004). The new vertices lie on the given surface.
// Throws InputError with a description of the fault if the mesh is empty, not manifold, not
// consistently oriented, or has degenerate triangles.
TriMesh RemeshIsotropic(const TriMesh& mesh, double edge_length);

}  // namespace lacuna

#endif  // LACUNA_SURFACE_REPAIR_H_
