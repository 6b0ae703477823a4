// A tetrahedral mesh cut open, to show what is inside.
#ifndef LACUNA_GEOMETRY_CUT_OPEN_H_
#define LACUNA_GEOMETRY_CUT_OPEN_H_

#include <Eigen/Core>

#include "geometry/tet_mesh.h"

namespace lacuna {

// The boundary of the tetrahedra that are left, whole, on one side of a plane. Vertices are all
// corner nodes of the mesh.
struct CutMesh {
  TriMesh skin;   // what was boundary before
  TriMesh inner;  // what the cut lays bare
};

// Leaves the tetrahedra whose centroid c has n·(c − p) ≤ 0, with p = `point` (m), n = `normal`.
CutMesh CutOpen(const TetMesh& mesh, const Eigen::Vector3d& point, const Eigen::Vector3d& normal);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_CUT_OPEN_H_
