// Derivatives of the first Piola–Kirchhoff stress, and the stiffness blocks that follow from them.
//
// A tangent C maps a change of the deformation gradient to a change of the stress, δP = C : δF.
// Nodes a and b of an element, with shape gradients g_a and g_b, are coupled by the 3 × 3 block
//   K_ab = ∂(P g_a)/∂x_b,      (K_ab)_ik = Σ_jl C_ijkl (g_a)_j (g_b)_l.
#ifndef LACUNA_FEM_STRESS_TANGENT_H_
#define LACUNA_FEM_STRESS_TANGENT_H_

#include <Eigen/Core>
#include <algorithm>
#include <iterator>

#include "fem/polar_decomposition.h"

namespace lacuna {

// C as a 9 × 9 matrix over column-major vectors: entry (i + 3j, k + 3l) is ∂P_ij/∂F_kl.
using StressTangent = Eigen::Matrix<double, 9, 9>;

// The stiffness blocks K_ab of an element's node pairs a ≤ b. Entries with the same place (i, k) in
// their blocks stand together, row by row of nodes b, so that sums run over many nodes at once.
template <int kNodes>
struct ElementStiffness {
  static constexpr int kWidth =
      (kNodes + 3) / 4 * 4;                       // of a row; what is beyond kNodes is not used
  alignas(64) double entry[9 * kNodes * kWidth];  // entries with a > b are not meaningful

  void SetZero() { std::fill(std::begin(entry), std::end(entry), 0.0); }
  Eigen::Matrix3d Block(int a, int b) const {
    Eigen::Matrix3d block;
    for (int ik = 0; ik < 9; ++ik) block(ik % 3, ik / 3) = entry[(ik * kNodes + a) * kWidth + b];
    return block;
  }
  void Add(int a, int b, const Eigen::Matrix3d& block) {
    for (int ik = 0; ik < 9; ++ik) entry[(ik * kNodes + a) * kWidth + b] += block(ik % 3, ik / 3);
  }
};

// Adds scale · K_ab to the entries of ElementStiffness. `gradient`: kNodes × 3, column-major.
void AddToEntriesOf4(const double* tangent, const double* gradient, double scale, double* entry);
void AddToEntriesOf10(const double* tangent, const double* gradient, double scale, double* entry);

// Adds scale · K_ab to the stiffness for all pairs of nodes of an element.
template <int kNodes>
void AddStiffness(const StressTangent& tangent, const Eigen::Matrix<double, kNodes, 3>& gradient,
                  double scale, ElementStiffness<kNodes>* stiffness) {
  static_assert(kNodes == 4 || kNodes == 10);
  if constexpr (kNodes == 4)
    AddToEntriesOf4(tangent.data(), gradient.data(), scale, stiffness->entry);
  else
    AddToEntriesOf10(tangent.data(), gradient.data(), scale, stiffness->entry);
}

// Adds scale · ∂²(det F)/∂F² to the tangent.
inline void AddCofactorDerivative(const Eigen::Matrix3d& F, double scale, StressTangent* tangent) {
  // block += c [v]×
  const auto add_cross = [](double c, const auto& v, auto block) {
    block(0, 1) -= c * v.z();
    block(0, 2) += c * v.y();
    block(1, 0) += c * v.z();
    block(1, 2) -= c * v.x();
    block(2, 0) -= c * v.y();
    block(2, 1) += c * v.x();
  };
  // Column j of the cofactor is the cross product of the two other columns of F.
  for (int j = 0; j < 3; ++j) {
    const int k = (j + 1) % 3;
    const int l = (j + 2) % 3;
    add_cross(-scale, F.col(l), tangent->block<3, 3>(3 * j, 3 * k));
    add_cross(scale, F.col(k), tangent->block<3, 3>(3 * j, 3 * l));
  }
}

// The tangent of an isotropic law in the axes of the principal stretches s (Smith, de Goes & Kim
// 2019, "Analytic eigensystems for isotropic distortion energies"). With ψ_i = ∂ψ/∂s_i, and entry k
// of `twist` and `flip` for the pair (i, j) of the two other axes:
//   stretch_ij = ∂²ψ/∂s_i∂s_j,   twist = (ψ_i + ψ_j)/(s_i + s_j),   flip = (ψ_i − ψ_j)/(s_i − s_j).
struct PrincipalTangent {
  Eigen::Matrix3d stretch;
  Eigen::Vector3d twist, flip;

  static PrincipalTangent Zero();
  // Adds the tangent of the energy density ½ c F : F, all of whose principal values are c.
  void AddIsotropic(double c);
  // Adds the tangent of a dependence on J = s₀ s₁ s₂, with the derivatives slope = ∂ψ/∂J and
  // curvature = ∂²ψ/∂J² at fixed F : F.
  void AddVolumetric(const Eigen::Vector3d& s, double slope, double curvature);
};

// The tangent with these principal values after its negative eigenvalues have been replaced by
// zero.
StressTangent ProjectedTangent(const SignedSvd& axes, const PrincipalTangent& principal);

// Whether the symmetric tangent has no negative eigenvalue up to rounding, by a Cholesky
// factorisation. False for a tangent with NaN.
bool IsPositiveSemidefinite(const StressTangent& tangent);

}  // namespace lacuna

#endif  // LACUNA_FEM_STRESS_TANGENT_H_
