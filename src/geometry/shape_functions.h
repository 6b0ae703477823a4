// Shape functions and quadrature of the linear and the quadratic tetrahedron.
#ifndef LACUNA_GEOMETRY_SHAPE_FUNCTIONS_H_
#define LACUNA_GEOMETRY_SHAPE_FUNCTIONS_H_

#include <Eigen/Core>
#include <array>

namespace lacuna {

// The corners at the ends of the six edges of a tetrahedron. Node 4 + k of a quadratic one is the
// midpoint of edge k.
inline constexpr std::array<std::array<int, 2>, 6> kTetEdges{
    {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

// The nodes of the faces opposite corners 0 to 3, counter-clockwise from outside: three corners,
// then, in a quadratic tetrahedron, the midpoints of their edges (0,1) (1,2) (2,0).
inline constexpr std::array<std::array<int, 6>, 4> kTetFaces{
    {{1, 2, 3, 5, 9, 8}, {0, 3, 2, 7, 9, 6}, {0, 1, 3, 4, 8, 7}, {0, 2, 1, 6, 5, 4}}};

// The shape functions N_a(ξ) of the 4 nodes (order 1) or 10 nodes (order 2) at the barycentric
// coordinates ξ, four numbers with sum 1, in the node order of TetMesh:
//   linear     N_a = ξ_a
//   quadratic  N_a = ξ_a (2 ξ_a − 1) at corners,   4 ξ_a ξ_b at the midpoint of edge (a, b)
// (Zienkiewicz & Taylor, The Finite Element Method, vol. 1).
Eigen::VectorXd ShapeValues(int order, const Eigen::Vector4d& barycentric);

// The derivatives ∂N_a/∂ξ_k (nodes × 4), where the four coordinates are treated as independent.
Eigen::MatrixX4d ShapeDerivatives(int order, const Eigen::Vector4d& barycentric);

// The derivatives of the shape functions along the three edges from corner 0 (nodes × 3), i.e. by
// the last three coordinates ξ where the first one is 1 minus their sum. With the nodes x (3 ×
// nodes), x · these is the Jacobian ∂x/∂ξ.
Eigen::MatrixX3d ShapeDerivativesAlongEdges(int order, const Eigen::Vector4d& barycentric);

// The barycentric coordinates of the nodes of an element, 4 × nodes.
Eigen::Matrix4Xd NodeCoordinates(int order);

struct TetQuadrature {
  Eigen::Matrix4Xd points;  // 4 × n, barycentric
  Eigen::VectorXd weights;  // n, sum 1
};
// The quadrature rule for an element of this order: the centroid for order 1, and four points,
// exact to degree 2, for order 2 (Hammer & Stroud 1956).
TetQuadrature ElementQuadrature(int order);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_SHAPE_FUNCTIONS_H_
