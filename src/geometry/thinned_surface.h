// A surface with fewer vertices, for drawing.
#ifndef LACUNA_GEOMETRY_THINNED_SURFACE_H_
#define LACUNA_GEOMETRY_THINNED_SURFACE_H_

#include <Eigen/Core>
#include <vector>

#include "geometry/tri_mesh.h"

namespace lacuna {

// Vertices of a surface that stand for all of them. Their positions and values are those of the
// surface, so that every state of it is thinned alike and nothing is interpolated.
struct ThinnedSurface {
  std::vector<int> kept;       // numbers of the vertices in the given surface, ascending
  Eigen::Matrix3Xi triangles;  // of the kept vertices, by their place in `kept`
};

// Clusters the vertices in the cells of a cubic grid (Rossignac & Borrel, Multi-resolution 3D
// approximations, 1993), fine enough that nearly `most` > 0 (CHECK) cells are occupied and never
// more. In each, the vertex nearest to the mean of the cell's vertices is kept; triangles whose
// corners fall into fewer than three cells vanish. A surface with at most `most` vertices is
// returned as it is.
ThinnedSurface ThinSurface(const TriMesh& surface, int most);

// At most `most` > 0 (CHECK) of the numbers 0 to count − 1, evenly spread, the first and the last
// one among them (of one: the last).
std::vector<int> EvenlySpread(int count, int most);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_THINNED_SURFACE_H_
