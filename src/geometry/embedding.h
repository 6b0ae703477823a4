// Material points inside a tetrahedral mesh, followed through its deformation.
#ifndef LACUNA_GEOMETRY_EMBEDDING_H_
#define LACUNA_GEOMETRY_EMBEDDING_H_

#include <Eigen/Core>
#include <vector>

#include "geometry/tet_mesh.h"

namespace lacuna {

struct Embedding {
  Eigen::VectorXi tet;     // n
  Eigen::MatrixXd weight;  // (nodes per tet) × n: shape functions N_a at the points, sum 1
  std::vector<Eigen::MatrixX3d> gradient;  // n of (nodes per tet) × 3: ∂N_a/∂X there, 1/m
  Eigen::VectorXd outside;                 // n: 0 inside; else −(smallest barycentric coordinate)
};

// Each point (3 × n, m) in the tetrahedron of `mesh` (at rest) that contains it, or, for a point
// outside, in the nearby one that it lies least far outside of: its weights then extrapolate.
Embedding Embed(const TetMesh& mesh, const Eigen::Matrix3Xd& points);

// The points at other node positions (3 × nodes).
Eigen::Matrix3Xd PointsAt(const Embedding& embedding, const TetMesh& mesh,
                          const Eigen::Matrix3Xd& nodes);

// F = ∂x/∂X at point j, for nodes at these positions (3 × nodes): a point that lies δ from where it
// was taken to be on the undeformed body is found F δ from where it was predicted.
Eigen::Matrix3d DeformationGradientAt(const Embedding& embedding, Eigen::Index j,
                                      const TetMesh& mesh,
                                      const Eigen::Ref<const Eigen::Matrix3Xd>& nodes);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_EMBEDDING_H_
