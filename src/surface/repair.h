// Mending triangle meshes, and evening their triangles.
#ifndef LACUNA_SURFACE_REPAIR_H_
#define LACUNA_SURFACE_REPAIR_H_

#include <limits>
#include <string>
#include <vector>

#include "geometry/tri_mesh.h"

namespace lacuna {

struct RepairOptions {
  // Drop all but the component of the largest area.
  bool keep_largest_component = true;
  // Flip or collapse triangles with an angle above 160° or edges in a ratio above 4, which may
  // shift the surface by a fraction of its mean edge. Exact shapes, such as CAD, do better without.
  bool remove_slivers = true;
  // Holes with a perimeter up to this are filled, m. Raising it closes larger gaps by guesswork.
  double max_hole_perimeter = std::numeric_limits<double>::infinity();
  // Leave the longest boundary loop open: the edge of an open surface.
  bool keep_longest_boundary = false;
  // Cut out triangles that cross others and close the cuts.
  bool remove_self_intersections = true;
};

struct RepairedSurface {
  TriMesh mesh;
  std::vector<std::string> notes;  // what was changed, one sentence each; empty: nothing
};

// Merges vertices in one place, drops repeated, degenerate and sliver triangles, parts non-manifold
// edges and vertices, orients the rest consistently (a closed one outward), fills holes and removes
// self-intersections, all by CGAL. What could not be mended is left as it is: the caller checks the
// result with CheckSurface. `mesh` may be any soup with indices in range and finite vertices.
RepairedSurface RepairSurface(const TriMesh& mesh, const RepairOptions& options = {});

struct RemeshOptions {
  // The length that edges approach, m.
  double edge_length = 0;
  // Raising it makes triangles more even, at proportional cost.
  int iterations = 4;
  // Edges that turn by more than this stay sharp, rad. π keeps none.
  double feature_angle = 3.15;
};

// Splits, collapses and flips edges, and shifts vertices along the surface, until edges are about
// `edge_length` long (Botsch & Kobbelt 2004, by CGAL). Vertices come to lie on the given surface.
// The mesh must be manifold and consistently oriented; throws InputError with the fault otherwise.
TriMesh RemeshIsotropic(const TriMesh& mesh, const RemeshOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SURFACE_REPAIR_H_
