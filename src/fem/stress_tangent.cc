#include "fem/stress_tangent.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace lacuna {
namespace {

using Vector9d = Eigen::Matrix<double, 9, 1>;

// vec(u ⊗ v)
Vector9d Dyad(const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
  Vector9d dyad;
  for (int j = 0; j < 3; ++j) dyad.segment<3>(3 * j) = u * v[j];
  return dyad;
}

}  // namespace

PrincipalTangent PrincipalTangent::Zero() {
  return {Eigen::Matrix3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
}

void PrincipalTangent::AddIsotropic(double c) {
  stretch.diagonal().array() += c;
  twist.array() += c;
  flip.array() += c;
}

void PrincipalTangent::AddVolumetric(const Eigen::Vector3d& s, double slope, double curvature) {
  const Eigen::Vector3d area(s[1] * s[2], s[2] * s[0], s[0] * s[1]);
  stretch += curvature * area * area.transpose();
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3;
    const int j = (k + 2) % 3;
    stretch(i, j) += slope * s[k];
    stretch(j, i) += slope * s[k];
    twist[k] += slope * s[k];
    flip[k] -= slope * s[k];
  }
}

StressTangent ProjectedTangent(const SignedSvd& axes, const PrincipalTangent& principal) {
  StressTangent tangent = StressTangent::Zero();
  const auto add_mode = [&tangent](double eigenvalue, const Vector9d& mode) {
    if (eigenvalue > 0) tangent += eigenvalue * mode * mode.transpose();
  };
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> stretch(principal.stretch);
  for (int k = 0; k < 3; ++k) {
    Vector9d mode = Vector9d::Zero();
    for (int i = 0; i < 3; ++i) {
      mode += stretch.eigenvectors()(i, k) * Dyad(axes.u.col(i), axes.v.col(i));
    }
    add_mode(stretch.eigenvalues()[k], mode);
  }
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3;
    const int j = (k + 2) % 3;
    const Vector9d ij = Dyad(axes.u.col(i), axes.v.col(j));
    const Vector9d ji = Dyad(axes.u.col(j), axes.v.col(i));
    add_mode(principal.twist[k], std::sqrt(0.5) * (ij - ji));
    add_mode(principal.flip[k], std::sqrt(0.5) * (ij + ji));
  }
  return tangent;
}

bool IsPositiveSemidefinite(const StressTangent& tangent) {
  const double rounding = 1e-13 * tangent.diagonal().cwiseAbs().maxCoeff();
  StressTangent L = tangent;
  for (int k = 0; k < 9; ++k) {
    const double pivot = L(k, k) - L.row(k).head(k).squaredNorm() + rounding;
    if (!(pivot > 0)) return false;
    L(k, k) = std::sqrt(pivot);
    for (int i = k + 1; i < 9; ++i) {
      L(i, k) = (L(i, k) - L.row(i).head(k).dot(L.row(k).head(k))) / L(k, k);
    }
  }
  return true;
}

}  // namespace lacuna
