// Rotation and stretch of a deformation gradient, sound for inverted elements too.
#ifndef LACUNA_FEM_POLAR_DECOMPOSITION_H_
#define LACUNA_FEM_POLAR_DECOMPOSITION_H_

#include <Eigen/Core>

namespace lacuna {

// F = U diag(s) Vᵀ with *rotations* U and V and s₀ ≥ s₁ ≥ |s₂|; s₂ < 0 where det F < 0 (Irving,
// Teran & Fedkiw 2004).
struct SignedSvd {
  Eigen::Matrix3d u, v;
  Eigen::Vector3d stretch;
};
SignedSvd ComputeSignedSvd(const Eigen::Matrix3d& F);

// The rotation nearest to F, R = U Vᵀ of the signed SVD, to rounding error. By Newton's iteration
// (Higham 1986), which is several times faster than an SVD, where det F is well above zero.
Eigen::Matrix3d PolarRotation(const Eigen::Matrix3d& F);

// Replaces each of `count` matrices by the rotation nearest to it. Several are dealt with at a time
// by vector instructions, so that each costs a fraction of a call of the above.
void ReplaceByRotations(int count, Eigen::Matrix3d* matrices);

// ∂(det F)/∂F.
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
