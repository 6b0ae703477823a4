// The Green–Lagrange strain, and symmetric tensors in Kelvin's notation.
//
// The strain E = ½ (FᵀF − I) is invariant under rotations and a polynomial of the deformation
// gradient F. It is conjugate to the second Piola–Kirchhoff stress S: the power per volume of the
// reference configuration is S : Ė, and the first Piola–Kirchhoff stress is P = F S (Bonet & Wood,
// Nonlinear Continuum Mechanics for Finite Element Analysis).
#ifndef LACUNA_FEM_GREEN_LAGRANGE_STRAIN_H_
#define LACUNA_FEM_GREEN_LAGRANGE_STRAIN_H_

#include <Eigen/Core>
#include <numbers>

#include "fem/lame_constants.h"

namespace lacuna {

// Kelvin's notation of a symmetric tensor A: (A₁₁, A₂₂, A₃₃, √2 A₂₃, √2 A₁₃, √2 A₁₂). A : B becomes
// the dot product, and fourth-order tensors become matrices with the same eigenvalues.
using KelvinVector = Eigen::Matrix<double, 6, 1>;
using KelvinMatrix = Eigen::Matrix<double, 6, 6>;

// Converts a symmetric tensor; only its upper triangle is read.
inline KelvinVector ToKelvin(const Eigen::Matrix3d& A) {
  using std::numbers::sqrt2;
  KelvinVector vector;
  vector << A(0, 0), A(1, 1), A(2, 2), sqrt2 * A(1, 2), sqrt2 * A(0, 2), sqrt2 * A(0, 1);
  return vector;
}

inline Eigen::Matrix3d FromKelvin(const KelvinVector& vector) {
  const Eigen::Vector3d shear = std::numbers::sqrt2 / 2 * vector.tail<3>();
  return Eigen::Matrix3d{{vector[0], shear[2], shear[1]},
                         {shear[2], vector[1], shear[0]},
                         {shear[1], shear[0], vector[2]}};
}

// The unit tensor; tr A = KelvinIdentity() · A.
inline KelvinVector KelvinIdentity() { return (KelvinVector() << 1, 1, 1, 0, 0, 0).finished(); }

// The deviatoric part A − ⅓ (tr A) I.
inline KelvinVector Deviator(KelvinVector vector) {
  vector.head<3>().array() -= vector.head<3>().mean();
  return vector;
}

// The elasticity matrix of Hooke's law, S = 2μ E + λ (tr E) I, in the unit of the constants.
inline KelvinMatrix IsotropicModuli(const LameConstants& constants) {
  KelvinMatrix moduli = constants.lambda * KelvinIdentity() * KelvinIdentity().transpose();
  moduli.diagonal().array() += 2 * constants.mu;
  return moduli;
}

// E = ½ (FᵀF − I).
inline KelvinVector GreenLagrangeStrain(const Eigen::Matrix3d& F) {
  KelvinVector strain = 0.5 * ToKelvin(F.transpose() * F);
  strain.head<3>().array() -= 0.5;
  return strain;
}

// The change ½ (Fᵀ δF + δFᵀ F) of the Green–Lagrange strain where F changes by δF.
inline KelvinVector StrainChange(const Eigen::Matrix3d& F, const Eigen::Matrix3d& change) {
  const Eigen::Matrix3d product = F.transpose() * change;
  return 0.5 * ToKelvin(product + product.transpose());
}

// ∂E/∂F (6 × 9), with F as a column-major vector.
inline Eigen::Matrix<double, 6, 9> StrainDerivative(const Eigen::Matrix3d& F) {
  Eigen::Matrix<double, 6, 9> derivative = Eigen::Matrix<double, 6, 9>::Zero();
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3;
    const int j = (k + 2) % 3;
    derivative.block<1, 3>(k, 3 * k) = F.col(k).transpose();
    derivative.block<1, 3>(3 + k, 3 * i) = std::numbers::sqrt2 / 2 * F.col(j).transpose();
    derivative.block<1, 3>(3 + k, 3 * j) = std::numbers::sqrt2 / 2 * F.col(i).transpose();
  }
  return derivative;
}

}  // namespace lacuna

#endif  // LACUNA_FEM_GREEN_LAGRANGE_STRAIN_H_
