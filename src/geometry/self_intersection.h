// Pairs of triangles that cut or touch one another where they should not.
#ifndef LACUNA_GEOMETRY_SELF_INTERSECTION_H_
#define LACUNA_GEOMETRY_SELF_INTERSECTION_H_

#include <vector>

#include "geometry/surface_check.h"

namespace lacuna {

// All pairs of triangles of `mesh` that meet elsewhere than in the vertices they share by index,
// ascending. Decided with exact predicates. Triangles without area are left out.
std::vector<SelfIntersection> FindSelfIntersections(const TriMesh& mesh);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_SELF_INTERSECTION_H_
