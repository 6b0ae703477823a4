// Material points inside a tetrahedral mesh, which follow its deformation.
#ifndef LACUNA_GEOMETRY_EMBEDDING_H_
#define LACUNA_GEOMETRY_EMBEDDING_H_

#include <Eigen/Core>
#include <vector>

#include "geometry/tet_mesh.h"

namespace lacuna {

// The location of n points in the reference configuration of a mesh:
//   x_j = Σ_a N_a(ξ_j) x_a   over the nodes a of one tetrahedron.
struct Embedding {
  Eigen::VectorXi tet;     // n: the tetrahedron of each point; −1: its location is not known
  Eigen::MatrixXd weight;  // (nodes per tet) × n: shape functions N_a at the points, sum 1
  std::vector<Eigen::MatrixX3d> gradient;  // n of (nodes per tet) × 3: ∂N_a/∂X at the points, 1/m
  // n: 0 for a point inside the mesh, else minus its least barycentric coordinate.
  Eigen::VectorXd outside;
};

// Locates each point (3 × n, m) in the tetrahedron of the undeformed `mesh` that contains it, by a
// search over all bounding boxes; on a common face, edge or node, in the one with the nearest
// centroid among those with the greatest least coordinate. In an element with curved edges the
// equation is solved by Newton's method, so that Σ_a N_a(ξ) x_a = x holds there, too. The mesh must
// have a tetrahedron, and none without volume (CHECK).
//
// A point outside the mesh gets the tetrahedron whose least barycentric coordinate is largest among
// those whose bounding boxes contain it and those with the nearest centroids, so that its weights
// extrapolate. Where the quadratic maps of curved elements do not reach it, the weights extrapolate
// linearly from the centroid; Σ_a N_a = 1 and Σ_a N_a x_a = x hold for them, too.
//
// A point that is not finite has no tetrahedron, and everything else about it is NaN.
Embedding Embed(const TetMesh& mesh, const Eigen::Matrix3Xd& points);

// The positions of the points (3 × n, m) for the node positions `nodes` (3 × nodes, m); NaN for
// points without a location.
Eigen::Matrix3Xd PointsAt(const Embedding& embedding, const TetMesh& mesh,
                          const Eigen::Matrix3Xd& nodes);

// The deformation gradient F = ∂x/∂X at point j, whose location is known, for the node positions
// `nodes` (3 × nodes, m). An error δ of the point's position in the reference configuration becomes
// F δ in the deformed one.
Eigen::Matrix3d DeformationGradientAt(const Embedding& embedding, Eigen::Index j,
                                      const TetMesh& mesh,
                                      const Eigen::Ref<const Eigen::Matrix3Xd>& nodes);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_EMBEDDING_H_
