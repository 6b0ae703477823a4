// The rotation and the principal stretches of a deformation gradient, also for inverted elements.
//
// The rotation nearest to F in the Frobenius norm is R = U Vᵀ of the signed singular value
// decomposition F = U diag(s) Vᵀ.
#ifndef LACUNA_FEM_POLAR_DECOMPOSITION_H_
#define LACUNA_FEM_POLAR_DECOMPOSITION_H_

#include <Eigen/Core>

namespace lacuna {

// The decomposition with rotations U and V (det = 1) and s₀ ≥ s₁ ≥ |s₂|, where s₂ < 0 if det F < 0
// (Irving, Teran & Fedkiw 2004).
struct SignedSvd {
  Eigen::Matrix3d u, v;
  Eigen::Vector3d stretch;
};
SignedSvd ComputeSignedSvd(const Eigen::Matrix3d& F);

// The rotation nearest to F, up to rounding errors. If det F is well above zero, it is computed by
// Newton's iteration (Higham 1986), which is several times faster than a decomposition. F must be
// finite.
Eigen::Matrix3d PolarRotation(const Eigen::Matrix3d& F);

// Replaces each of `count` matrices by the rotation nearest to it. Vector instructions process
// several matrices at once, at a fraction of the cost of PolarRotation.
void ReplaceByRotations(int count, Eigen::Matrix3d* matrices);

// The cofactor matrix ∂(det F)/∂F.
inline Eigen::Matrix3d Cofactor(const Eigen::Matrix3d& F) {
  Eigen::Matrix3d cofactor;
  cofactor.col(0) << F(1, 1) * F(2, 2) - F(2, 1) * F(1, 2), F(2, 1) * F(0, 2) - F(0, 1) * F(2, 2),
      F(0, 1) * F(1, 2) - F(1, 1) * F(0, 2);
  cofactor.col(1) << F(1, 2) * F(2, 0) - F(2, 2) * F(1, 0), F(2, 2) * F(0, 0) - F(0, 2) * F(2, 0),
      F(0, 2) * F(1, 0) - F(1, 2) * F(0, 0);
  cofactor.col(2) << F(1, 0) * F(2, 1) - F(2, 0) * F(1, 1), F(2, 0) * F(0, 1) - F(0, 0) * F(2, 1),
      F(0, 0) * F(1, 1) - F(1, 0) * F(0, 1);
  return cofactor;
}

}  // namespace lacuna

#endif  // LACUNA_FEM_POLAR_DECOMPOSITION_H_
