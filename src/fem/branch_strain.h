// The strain to which branches with memory refer (memory_branch.h): the Green–Lagrange strain E
// with the change of volume in the place of its trace,
//   B = E − ⅓ (tr E) I + ⅓ (J − 1) I,    J = det F.
//
// At small strain B = E. In a motion that keeps the volume tr B = 0 at any strain, whereas tr E is
// positive and of second order: 0.053 in a stretch by 20 %. With Hooke's law for a nearly
// incompressible solid λ (tr E) I would be many times the stress that is meant: at a Poisson's
// ratio of 0.499, λ tr E is 8.9 m with Young's modulus m, instead of 0.2 m. B is a polynomial of F
// and invariant under rotations, as E is.
//
// The stress Q that is conjugate to B has the power Q : Ḃ per volume of the reference
// configuration; the first Piola–Kirchhoff stress is
//   P = F dev Q + ⅓ (tr Q) cof F,    cof F = ∂J/∂F,    dev Q = Q − ⅓ (tr Q) I.
#ifndef LACUNA_FEM_BRANCH_STRAIN_H_
#define LACUNA_FEM_BRANCH_STRAIN_H_

#include <Eigen/Core>

#include "fem/green_lagrange_strain.h"
#include "fem/polar_decomposition.h"
#include "fem/stress_tangent.h"

namespace lacuna {

// B.
inline KelvinVector BranchStrain(const Eigen::Matrix3d& F) {
  KelvinVector strain = Deviator(GreenLagrangeStrain(F));
  strain.head<3>().array() += (F.determinant() - 1) / 3;
  return strain;
}

// The change of B where F changes by `change`.
inline KelvinVector BranchStrainChange(const Eigen::Matrix3d& F, const Eigen::Matrix3d& change) {
  KelvinVector strain = Deviator(StrainChange(F, change));
  strain.head<3>().array() += Cofactor(F).cwiseProduct(change).sum() / 3;
  return strain;
}

// The first Piola–Kirchhoff stress of Q.
inline Eigen::Matrix3d StressOfBranch(const Eigen::Matrix3d& F, const KelvinVector& Q) {
  return F * FromKelvin(Deviator(Q)) + Q.head<3>().mean() * Cofactor(F);
}

// ∂P/∂F where Q = `stress` and ∂Q/∂B = `moduli`, in the same unit, e.g. Pa.
inline StressTangent TangentOfBranch(const Eigen::Matrix3d& F, const KelvinVector& stress,
                                     const KelvinMatrix& moduli) {
  const Eigen::Matrix3d cofactor = Cofactor(F);
  const Eigen::Map<const Eigen::Matrix<double, 1, 9>> by_volume(cofactor.data());
  Eigen::Matrix<double, 6, 9> strain_derivative = StrainDerivative(F);  // ∂B/∂F
  const Eigen::Matrix<double, 1, 9> excess =
      (by_volume - strain_derivative.topRows<3>().colwise().sum()) / 3;
  strain_derivative.topRows<3>().rowwise() += excess;
  StressTangent tangent = strain_derivative.transpose() * moduli * strain_derivative;
  const Eigen::Matrix3d deviator = FromKelvin(Deviator(stress));
  for (int j = 0; j < 3; ++j)
    for (int l = 0; l < 3; ++l)
      tangent.block<3, 3>(3 * j, 3 * l).diagonal().array() += deviator(j, l);
  AddCofactorDerivative(F, stress.head<3>().mean(), &tangent);
  return tangent;
}

}  // namespace lacuna

#endif  // LACUNA_FEM_BRANCH_STRAIN_H_
