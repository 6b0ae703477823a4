// Operations on a single element from which effects in the volume are built.
//
// `kNodes` is the number of nodes of an element, 4 for linear and 10 for quadratic tetrahedra. With
// the nodal values u_a (columns of a 3 × kNodes matrix) and the shape gradients g_a = ∂N_a/∂X at a
// quadrature point, the gradient of the field is Σ_a u_a ⊗ g_a. Nodal fields are 3n, node-major.
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

// Gathers the values of a nodal field (3n) at the nodes of an element.
template <int kNodes>
Eigen::Matrix<double, 3, kNodes> GatherNodes(const Body& body, int element,
                                             const Eigen::VectorXd& field) {
  Eigen::Matrix<double, 3, kNodes> nodal;
  const int* node = &body.mesh.tets(0, element);
  for (int a = 0; a < kNodes; ++a) nodal.col(a) = field.segment<3>(3 * node[a]);
  return nodal;
}

// Adds values at the nodes of an element to a nodal field (3n). Only inside ForEachElement or
// ForEachBatch, which exclude concurrent access to the same node.
template <int kNodes>
void ScatterNodes(const Body& body, int element, const Eigen::Matrix<double, 3, kNodes>& nodal,
                  Eigen::VectorXd* field) {
  const int* node = &body.mesh.tets(0, element);
  for (int a = 0; a < kNodes; ++a) field->segment<3>(3 * node[a]) += nodal.col(a);
}

// The shape gradients ∂N/∂X at quadrature point q, kNodes × 3, 1/m. Refers to the body.
template <int kNodes>
Eigen::Map<const Eigen::Matrix<double, kNodes, 3>> ShapeGradient(const Body& body, int q) {
  return Eigen::Map<const Eigen::Matrix<double, kNodes, 3>>(&body.shape_gradient(0, 3 * q));
}

// Σ_a u_a ⊗ g_a: the deformation gradient F if the nodal values are positions, and its rate if they
// are velocities. Since Σ g_a = 0, the value of the first node can be subtracted, which avoids
// cancellation far from the origin.
template <int kNodes, typename Gradient>
EIGEN_STRONG_INLINE Eigen::Matrix3d FieldGradient(const Eigen::Matrix<double, 3, kNodes>& nodal,
                                                  const Gradient& gradient) {
  const Eigen::Matrix<double, 3, kNodes - 1> edges =
      nodal.template rightCols<kNodes - 1>().colwise() - nodal.col(0);
  return edges.lazyProduct(gradient.template bottomRows<kNodes - 1>());
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
