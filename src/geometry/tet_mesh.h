// A tetrahedral mesh with linear or quadratic elements, and its boundary.
#ifndef LACUNA_GEOMETRY_TET_MESH_H_
#define LACUNA_GEOMETRY_TET_MESH_H_

#include <Eigen/Core>

#include "geometry/tri_mesh.h"

namespace lacuna {

// Column e of `tets` lists the nodes of tetrahedron e: the four corners a, b, c, d with
// (b−a)×(c−a)·(d−a) > 0, and for order 2 the midpoints of the six edges (0,1) (1,2) (0,2) (0,3)
// (1,3) (2,3), which is VTK's order.
struct TetMesh {
  Eigen::Matrix3Xd nodes;  // 3 × n, m
  Eigen::MatrixXi tets;    // 4 × m (linear) or 10 × m (quadratic), 0-based

  Eigen::Index NodeCount() const { return nodes.cols(); }
  Eigen::Index TetCount() const { return tets.cols(); }
  int Order() const { return tets.rows() == 10 ? 2 : 1; }
};

// The signed volume (m³) of each tetrahedron, computed from its corners.
Eigen::VectorXd TetVolumes(const TetMesh& mesh);

// Whether each midpoint of tetrahedron `tet` lies halfway between its corners, up to rounding, so
// that barycentric coordinates are those of the corners; true in a linear mesh.
bool HasStraightEdges(const TetMesh& mesh, Eigen::Index tet);

// The signed volume (m³) that the tetrahedra fill in addition to TetVolumes because their edges are
// curved, Σ_e ∫ det(∂x/∂ξ) dξ − V_e; 0 if all edges are straight.
double VolumeOfCurvature(const TetMesh& mesh);

// The first tetrahedron whose corners lie in one plane up to the rounding of its volume or of its
// coordinates, |V| ≤ 1e-14 h³ + 2 ε c h² with the longest edge h from its first corner and its
// largest coordinate c; −1 if there is none. ReadTetMesh refuses such a mesh.
Eigen::Index FindFlatTet(const TetMesh& mesh);

// The quadratic mesh of a linear one, with an additional node at the midpoint of each edge; corner
// nodes keep their numbers. A mesh that is already quadratic is returned unchanged.
TetMesh ToQuadratic(const TetMesh& linear);

// The boundary of a mesh, oriented outward. For order 2 each boundary face becomes four triangles,
// so that the surface follows the edge nodes, too.
struct BoundarySurface {
  TriMesh surface;
  Eigen::VectorXi node;   // n_surface: the mesh node of each vertex of `surface`
  Eigen::MatrixXi faces;  // 3 or 6 × m_faces: the mesh nodes of each boundary face
};
BoundarySurface ExtractBoundary(const TetMesh& mesh);

// The surface of `boundary` for the node positions `nodes` (3 × n, m) of the mesh; CHECKs that
// there are enough nodes.
TriMesh BoundaryAt(const BoundarySurface& boundary, const Eigen::Matrix3Xd& nodes);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_TET_MESH_H_
