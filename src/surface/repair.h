// Repair and isotropic remeshing of triangle meshes with CGAL.
#ifndef LACUNA_SURFACE_REPAIR_H_
#define LACUNA_SURFACE_REPAIR_H_

#include <limits>
#include <string>
#include <vector>

#include "geometry/tri_mesh.h"

namespace lacuna {

struct RepairOptions {
  // Keep only the component with the largest area.
  bool keep_largest_component = true;
  // Flip or collapse triangles with an angle above 160° or an edge ratio above 4. This may shift
  // the surface by a fraction of the mean edge length, so it should be disabled for exact shapes
  // such as CAD models.
  bool remove_slivers = true;
  // Holes are filled up to this perimeter, m. Raising it fills larger holes with surface that has
  // not been measured.
  double max_hole_perimeter = std::numeric_limits<double>::infinity();
  // Do not fill the longest boundary loop, which is the rim of an open surface.
  bool keep_longest_boundary = false;
  // Cut out triangles that cross others and close the resulting holes.
  bool remove_self_intersections = true;
};

struct RepairedSurface {
  TriMesh mesh;
  std::vector<std::string> notes;  // one entry for each change
};

// Merges coincident vertices, removes repeated, degenerate and sliver triangles, splits
// non-manifold edges and vertices, orients the triangles consistently (a closed surface outward),
// fills holes and removes self-intersections. Faults that cannot be repaired remain, so the caller
// should check the result with CheckSurface. `mesh` may be any set of triangles with indices in
// range and finite vertices.
RepairedSurface RepairSurface(const TriMesh& mesh, const RepairOptions& options = {});

struct RemeshOptions {
  // The target edge length, m; must be positive (CHECK).
  double edge_length = 0;
  // Number of passes. Raising it makes the triangles more uniform; the time grows in proportion.
  int iterations = 4;
  // Edges with a larger angle between the normals of their triangles stay sharp, rad. A value of π
  // or more keeps no sharp edges.
  double feature_angle = 3.15;
};

// Splits, collapses and flips edges and moves vertices along the surface until edges are about
// `edge_length` long (M. Botsch and L. Kobbelt, "A remeshing approach to multiresolution modeling",
// SGP 2004). The new vertices lie on the given surface. Throws InputError with a description of the
// fault if the mesh is empty, not manifold, not consistently oriented, or has degenerate triangles.
TriMesh RemeshIsotropic(const TriMesh& mesh, const RemeshOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SURFACE_REPAIR_H_
