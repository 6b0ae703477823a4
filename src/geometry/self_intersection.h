// Detection of triangle pairs that cut or touch one another where a surface should not meet itself.
#ifndef LACUNA_GEOMETRY_SELF_INTERSECTION_H_
#define LACUNA_GEOMETRY_SELF_INTERSECTION_H_

#include <Eigen/Core>
#include <vector>

#include "geometry/tri_mesh.h"

namespace lacuna {

// Two triangles that meet elsewhere than in the vertices they share.
struct SelfIntersection {
  int first = -1, second = -1;  // triangle indices, first < second
  Eigen::Vector3d place;        // centre of the intersection of their bounding boxes, m
};

// Returns all pairs of triangles of `mesh` that meet elsewhere than in vertices they share by
// index, in ascending order of (first, second). The tests use CGAL's exact predicates, so the
// answer does not depend on rounding. Triangles without area are ignored. Indices must be in range
// and vertices finite.
std::vector<SelfIntersection> FindSelfIntersections(const TriMesh& mesh);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_SELF_INTERSECTION_H_
