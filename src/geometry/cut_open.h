// Cutting a tetrahedral mesh open along a plane, to show its inside.
#ifndef LACUNA_GEOMETRY_CUT_OPEN_H_
#define LACUNA_GEOMETRY_CUT_OPEN_H_

#include <Eigen/Core>

#include "geometry/tet_mesh.h"

namespace lacuna {

// The boundary of the tetrahedra that remain on one side of a plane. No tetrahedron is divided, so
// the cut surface is jagged. The vertices of both meshes are all nodes of the given mesh.
struct CutMesh {
  TriMesh skin;   // faces that were already on the boundary of the mesh
  TriMesh inner;  // faces that the cut exposes
};

// Keeps the tetrahedra whose centroid c satisfies n·(c − p) ≤ 0, with p = `point` (m) and n =
// `normal`, of any length but 0. Both results are empty if none remains.
CutMesh CutOpen(const TetMesh& mesh, const Eigen::Vector3d& point, const Eigen::Vector3d& normal);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_CUT_OPEN_H_
