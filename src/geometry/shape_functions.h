// Shape functions of the linear and the quadratic tetrahedron in barycentric coordinates.
#ifndef LACUNA_GEOMETRY_SHAPE_FUNCTIONS_H_
#define LACUNA_GEOMETRY_SHAPE_FUNCTIONS_H_

#include <Eigen/Core>

namespace lacuna {

// N_a(ξ) of the 4 or 10 nodes at barycentric coordinates ξ (four numbers that sum to 1), in the
// node order of TetMesh:
//   linear     N_a = ξ_a
//   quadratic  N_a = ξ_a (2 ξ_a − 1) at corners,   4 ξ_a ξ_b at the midpoint of edge (a, b)
// (Zienkiewicz & Taylor, The Finite Element Method, vol. 1).
Eigen::VectorXd ShapeValues(int order, const Eigen::Vector4d& barycentric);

// ∂N_a/∂ξ_k with the four coordinates taken as independent: nodes × 4.
Eigen::MatrixX4d ShapeDerivatives(int order, const Eigen::Vector4d& barycentric);

// Barycentric points (4 × n) and weights (sum 1) of the rule that an element of this order is
// integrated with: the centroid for order 1, four points exact to degree 2 for order 2
// (Hammer & Stroud 1956).
struct TetQuadrature {
  Eigen::Matrix4Xd points;
  Eigen::VectorXd weights;
};
TetQuadrature ElementQuadrature(int order);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_SHAPE_FUNCTIONS_H_
