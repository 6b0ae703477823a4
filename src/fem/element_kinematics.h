// Operations on a single element from which effects in the volume are built.
//
// `kNodes` is the number of nodes of an element, 4 for linear and 10 for quadratic tetrahedra. With
// the nodal values u_a (columns of a 3 × kNodes matrix) and the shape gradients g_a = ∂N_a/∂X at a
// quadrature point, the gradient of the field is Σ_a u_a ⊗ g_a. Nodal fields are 3n, node-major.
// Results at the points of an element are arrays of QuadraturePoints<kNodes>() matrices.
#ifndef LACUNA_FEM_ELEMENT_KINEMATICS_H_
#define LACUNA_FEM_ELEMENT_KINEMATICS_H_

#include <Eigen/Core>
#include <type_traits>

#include "fem/block_matrix.h"
#include "fem/body.h"
#include "fem/stress_tangent.h"

namespace lacuna {

// Calls visit(std::integral_constant<int, kNodes>()) with the element type of the body, which turns
// the order of the mesh into a compile-time constant.
template <typename Visit>
auto WithNodesPerElement(const Body& body, const Visit& visit) {
  if (body.mesh.Order() == 1) return visit(std::integral_constant<int, 4>());
  return visit(std::integral_constant<int, 10>());
}

// The number of quadrature points of an element.
template <int kNodes>
constexpr int QuadraturePoints() {
  static_assert(kNodes == 4 || kNodes == 10);
  return kNodes == 4 ? 1 : 4;
}

// The shape gradients ∂N/∂X at quadrature point q, kNodes × 3, 1/m. Refers to the body.
template <int kNodes>
Eigen::Map<const Eigen::Matrix<double, kNodes, 3>> ShapeGradient(const Body& body, int q) {
  return Eigen::Map<const Eigen::Matrix<double, kNodes, 3>>(&body.shape_gradient(0, 3 * q));
}

// The operations of FieldGradients and AddPointForces on plain arrays, for elements of 4 or 10
// nodes with the numbers `node`. `shape_gradient` holds the shape gradients at all quadrature
// points of the element, one point after another; `gradient` and `P` hold one 3 × 3 matrix per
// point, column-major. GradientsOf… overwrites `gradient` with Σ_a u_a ⊗ g_a of the nodal field u;
// SubtractForcesOf… subtracts Σ_q P_q g_a(q) from the field at each node a.
void GradientsOf4(const double* field, const int* node, const double* shape_gradient,
                  double* gradient);
void GradientsOf10(const double* field, const int* node, const double* shape_gradient,
                   double* gradient);
void SubtractForcesOf4(const double* P, const int* node, const double* shape_gradient,
                       double* field);
void SubtractForcesOf10(const double* P, const int* node, const double* shape_gradient,
                        double* field);

// Σ_a u_a ⊗ g_a at the points of an element: the deformation gradients F if the field holds
// positions, and their rates if it holds velocities. Since Σ g_a = 0, the value of the first node
// is subtracted, which avoids cancellation far from the origin.
template <int kNodes>
void FieldGradients(const Body& body, int element, const double* field,
                    Eigen::Matrix3d* gradients) {
  const int* node = &body.mesh.tets(0, element);
  const double* shape = &body.shape_gradient(0, 3 * element * QuadraturePoints<kNodes>());
  if constexpr (kNodes == 4)
    GradientsOf4(field, node, shape, gradients->data());
  else
    GradientsOf10(field, node, shape, gradients->data());
}
template <int kNodes>
void FieldGradients(const Body& body, int element, const Eigen::VectorXd& field,
                    Eigen::Matrix3d* gradients) {
  FieldGradients<kNodes>(body, element, field.data(), gradients);
}

// Adds the nodal forces −Σ_q P_q g_a(q) of an element to `force` (3n, N), for first Piola–Kirchhoff
// stresses at its points times their weights (Pa m³). Only inside ForEachElement or ForEachBatch,
// which exclude concurrent access to the same node.
template <int kNodes>
void AddPointForces(const Body& body, int element, const Eigen::Matrix3d* weighted_stress,
                    double* force) {
  const int* node = &body.mesh.tets(0, element);
  const double* shape = &body.shape_gradient(0, 3 * element * QuadraturePoints<kNodes>());
  if constexpr (kNodes == 4)
    SubtractForcesOf4(weighted_stress->data(), node, shape, force);
  else
    SubtractForcesOf10(weighted_stress->data(), node, shape, force);
}
template <int kNodes>
void AddPointForces(const Body& body, int element, const Eigen::Matrix3d* weighted_stress,
                    Eigen::VectorXd* force) {
  AddPointForces<kNodes>(body, element, weighted_stress, force->data());
}

// Adds an element matrix K to a tangent, with K_ba = kMirror K_abᵀ: symmetric for kMirror = 1 and
// skew-symmetric for −1. Only inside ForEachElement or ForEachBatch.
template <int kNodes, int kMirror = 1>
void ScatterStiffness(const Body& body, int element, const ElementStiffness<kNodes>& stiffness,
                      BlockMatrix* tangent) {
  const int* position = &body.schedule->block[static_cast<size_t>(element) * kNodes * kNodes];
  for (int a = 0; a < kNodes; ++a) {
    tangent->Block(position[a * kNodes + a]) += stiffness.Block(a, a);
    for (int b = a + 1; b < kNodes; ++b) {
      const Eigen::Matrix3d block = stiffness.Block(a, b);
      tangent->Block(position[a * kNodes + b]) += block;
      tangent->Block(position[b * kNodes + a]) += kMirror * block.transpose();
    }
  }
}

}  // namespace lacuna

#endif  // LACUNA_FEM_ELEMENT_KINEMATICS_H_
