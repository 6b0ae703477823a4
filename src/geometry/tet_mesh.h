// A tetrahedral mesh of order 1 or 2 and its boundary.
#ifndef LACUNA_GEOMETRY_TET_MESH_H_
#define LACUNA_GEOMETRY_TET_MESH_H_

#include <Eigen/Core>

#include "geometry/tri_mesh.h"

namespace lacuna {

// Column e of `tets` lists the nodes of tetrahedron e: four corners, (b−a)×(c−a)·(d−a) > 0, and
// for order 2 the six edge midpoints of (0,1) (1,2) (0,2) (0,3) (1,3) (2,3), as VTK orders them.
struct TetMesh {
  Eigen::Matrix3Xd nodes;  // 3 × n, m
  Eigen::MatrixXi tets;    // 4 × m (linear) or 10 × m (quadratic), 0-based

  Eigen::Index NodeCount() const { return nodes.cols(); }
  Eigen::Index TetCount() const { return tets.cols(); }
  int Order() const { return tets.rows() == 10 ? 2 : 1; }
};

// Signed volume of each tetrahedron's corners, m³.
Eigen::VectorXd TetVolumes(const TetMesh& mesh);

// The same mesh with a node on each edge's midpoint; corner nodes keep their numbers. A mesh that
// is quadratic already comes back as it is.
TetMesh ToQuadratic(const TetMesh& linear);

// The boundary of the mesh, oriented outward. `node` maps the vertices of `surface` to nodes of
// the mesh. For order 2 each boundary face becomes four triangles, so that the surface follows the
// edge nodes too.
struct BoundarySurface {
  TriMesh surface;
  Eigen::VectorXi node;   // n_surface
  Eigen::MatrixXi faces;  // 3 or 6 × m_faces: the mesh nodes of each boundary face
};
BoundarySurface ExtractBoundary(const TetMesh& mesh);

// The boundary's triangles at other node positions (3 × n).
TriMesh BoundaryAt(const BoundarySurface& boundary, const Eigen::Matrix3Xd& nodes);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_TET_MESH_H_
