// Shape functions of the faces of linear and quadratic tetrahedra.
//
// A face has three corners, counter-clockwise seen from outside, and in a quadratic mesh also the
// midpoints of its edges (0,1) (1,2) (2,0). At the barycentric coordinates l₀, l₁, l₂ (sum 1)
//   linear     N_a = l_a
//   quadratic  N_a = l_a (2 l_a − 1) at corners,   4 l_a l_b at the midpoint of edge (a, b)
// (Zienkiewicz & Taylor, The Finite Element Method, vol. 1).
#ifndef LACUNA_GEOMETRY_FACE_SHAPE_FUNCTIONS_H_
#define LACUNA_GEOMETRY_FACE_SHAPE_FUNCTIONS_H_

#include <Eigen/Core>
#include <array>

namespace lacuna {

// The four triangles of BoundarySurface::surface that make up a six-node face, by the local numbers
// of its nodes.
inline constexpr std::array<std::array<int, 3>, 4> kFaceQuarters{
    {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};

// The shape functions of a face with kNodes nodes at a point, and their derivatives by the two
// coordinates l₁ and l₂ of the face, with l₀ = 1 − l₁ − l₂. The cross product of the two tangents
// Σ_a ∂N_a/∂l₁ x_a and Σ_a ∂N_a/∂l₂ x_a points outwards; its length is twice the area of a linear
// face.
template <int kNodes>
struct FaceShape {
  Eigen::Vector<double, kNodes> value;
  Eigen::Vector<double, kNodes> by_first;   // ∂N/∂l₁
  Eigen::Vector<double, kNodes> by_second;  // ∂N/∂l₂
};
FaceShape<3> LinearFaceShape(const Eigen::Vector3d& barycentric);
FaceShape<6> QuadraticFaceShape(const Eigen::Vector3d& barycentric);

// The barycentric coordinates of the six nodes of a quadratic face, one per column.
Eigen::Matrix<double, 3, 6> FaceNodeCoordinates();

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_FACE_SHAPE_FUNCTIONS_H_
