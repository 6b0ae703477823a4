// The few operations on one element that every volume effect is made of. `kNodes` is 4 or 10.
#ifndef LACUNA_FEM_ELEMENT_KINEMATICS_H_
#define LACUNA_FEM_ELEMENT_KINEMATICS_H_

#include <Eigen/Core>
#include <type_traits>

#include "fem/block_matrix.h"
#include "fem/body.h"
#include "fem/stress_tangent.h"

namespace lacuna {

// Calls visit(std::integral_constant<int, nodes per element>).
template <typename Visit>
auto WithNodesPerElement(const Body& body, const Visit& visit) {
  if (body.mesh.Order() == 1) return visit(std::integral_constant<int, 4>());
  return visit(std::integral_constant<int, 10>());
}

template <int kNodes>
constexpr int QuadraturePoints() {
  static_assert(kNodes == 4 || kNodes == 10);
  return kNodes == 4 ? 1 : 4;
}

// The element's columns of a nodal field (3n, node-major).
template <int kNodes>
Eigen::Matrix<double, 3, kNodes> GatherNodes(const Body& body, int element,
                                             const Eigen::VectorXd& field) {
  Eigen::Matrix<double, 3, kNodes> nodal;
  const int* node = &body.mesh.tets(0, element);
  for (int a = 0; a < kNodes; ++a) nodal.col(a) = field.segment<3>(3 * node[a]);
  return nodal;
}

// field += nodal; only inside ForEachElement.
template <int kNodes>
void ScatterNodes(const Body& body, int element, const Eigen::Matrix<double, 3, kNodes>& nodal,
                  Eigen::VectorXd* field) {
  const int* node = &body.mesh.tets(0, element);
  for (int a = 0; a < kNodes; ++a) field->segment<3>(3 * node[a]) += nodal.col(a);
}

// ∂N/∂X at quadrature point q, kNodes × 3.
template <int kNodes>
Eigen::Map<const Eigen::Matrix<double, kNodes, 3>> ShapeGradient(const Body& body, int q) {
  return Eigen::Map<const Eigen::Matrix<double, kNodes, 3>>(&body.shape_gradient(0, 3 * q));
}

// Σ_a u_a ⊗ g_a: the deformation gradient when u are positions, its rate when they are velocities.
// Differences to the first node keep it exact to rounding far from the origin (Σ g_a = 0).
template <int kNodes, typename Gradient>
EIGEN_STRONG_INLINE Eigen::Matrix3d FieldGradient(const Eigen::Matrix<double, 3, kNodes>& nodal,
                                                  const Gradient& gradient) {
  const Eigen::Matrix<double, 3, kNodes - 1> edges =
      nodal.template rightCols<kNodes - 1>().colwise() - nodal.col(0);
  return edges.lazyProduct(gradient.template bottomRows<kNodes - 1>());
}

// tangent += K for both triangles of the element matrix, K_ba = kMirror K_abᵀ: symmetric, or with
// −1 skew-symmetric; only inside ForEachElement.
template <int kNodes, int kMirror = 1>
void ScatterStiffness(const Body& body, int element, const ElementStiffness<kNodes>& stiffness,
                      BlockMatrix* tangent) {
  const int* position = &body.schedule->block[static_cast<size_t>(element) * kNodes * kNodes];
  int pair = 0;
  for (int a = 0; a < kNodes; ++a) {
    tangent->Block(position[a * kNodes + a]) += stiffness.block[pair++];
    for (int b = a + 1; b < kNodes; ++b) {
      tangent->Block(position[a * kNodes + b]) += stiffness.block[pair];
      tangent->Block(position[b * kNodes + a]) += kMirror * stiffness.block[pair++].transpose();
    }
  }
}

}  // namespace lacuna

#endif  // LACUNA_FEM_ELEMENT_KINEMATICS_H_
