#include "fem/polar_decomposition.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace lacuna {
namespace {

// Newton's iteration X ← ½ (γ X + X⁻ᵀ/γ). False where F is too near a singular or inverted one for
// it to be fast and accurate.
bool NewtonRotation(const Eigen::Matrix3d& F, Eigen::Matrix3d* rotation) {
  constexpr int kMaxIterations = 12;
  Eigen::Matrix3d X = F;
  Eigen::Matrix3d cofactor = Cofactor(X);
  double determinant = X.col(0).dot(cofactor.col(0));
  const double size = X.squaredNorm();
  if (!(determinant > 1e-3 * size * std::sqrt(size))) return false;
  for (int k = 0; k < kMaxIterations; ++k) {
    Eigen::Matrix3d next = 0.5 * (X + cofactor / determinant);
    const double change = (next - X).squaredNorm();
    if (change > 0.1) {
      // Far away, the scale that balances X and its inverse saves iterations.
      const double scale =
          std::sqrt(std::sqrt(cofactor.squaredNorm() / X.squaredNorm()) / determinant);
      next = 0.5 * (scale * X + cofactor / (scale * determinant));
    }
    X = next;
    // Convergence is quadratic: after a change of 1e-8 the error is at rounding.
    if (change < 1e-17) {
      *rotation = X;
      return true;
    }
    cofactor = Cofactor(X);
    determinant = X.col(0).dot(cofactor.col(0));
  }
  return false;
}

}  // namespace

SignedSvd ComputeSignedSvd(const Eigen::Matrix3d& F) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  SignedSvd result{svd.matrixU(), svd.matrixV(), svd.singularValues()};
  if (result.u.determinant() < 0) {
    result.u.col(2) *= -1;
    result.stretch[2] *= -1;
  }
  if (result.v.determinant() < 0) {
    result.v.col(2) *= -1;
    result.stretch[2] *= -1;
  }
  return result;
}

Eigen::Matrix3d PolarRotation(const Eigen::Matrix3d& F) {
  Eigen::Matrix3d rotation;
  if (NewtonRotation(F, &rotation)) return rotation;
  const SignedSvd svd = ComputeSignedSvd(F);
  return svd.u * svd.v.transpose();
}

}  // namespace lacuna
