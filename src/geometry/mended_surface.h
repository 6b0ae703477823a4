// Mending of a surface as a file lists it: many programs write vertices once for each face, faces
// twice, or faces that are seen from inside.
#ifndef LACUNA_GEOMETRY_MENDED_SURFACE_H_
#define LACUNA_GEOMETRY_MENDED_SURFACE_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "geometry/tri_mesh.h"

namespace lacuna {

struct MendedSurface {
  TriMesh mesh;
  Eigen::VectorXi vertex_in_file;  // index of each vertex among the given ones, ascending
  std::vector<std::string> notes;  // one sentence for each kind of change
};

// In this order:
//   * Vertices with equal coordinates are merged into the first of them. With `is_stl` this has no
//     note, because an STL file lists the corners of each triangle; there, vertices at open edges
//     that differ by less than 1e-5 of the largest coordinate, the sixth digit, are merged, too,
//     with a note.
//   * Triangles with a repeated corner, and those with the same three corners as an earlier one,
//     whatever their orientation, are dropped.
//   * Vertices that no triangle uses are dropped.
//   * Of triangles that are connected by edges of two triangles, the fewer ones are turned where
//     orientations differ, unless the surface is one-sided, such as a Möbius strip.
//   * A closed component of negative volume is turned, unless it lies within the bounding box of
//     another closed component: it may be the wall of a cavity.
// Holes, edges of three triangles, triangles without area and self-intersections remain as they
// are. Of a sound surface neither vertices nor triangles nor their order change. `given` may be any
// set of triangles with indices in range and finite vertices, in any unit of length.
MendedSurface MendSurface(const TriMesh& given, bool is_stl = false);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_MENDED_SURFACE_H_
