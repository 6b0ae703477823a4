#include "fem/stress_tangent.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "fem/target_clones.h"

namespace lacuna {
namespace {

using Vector9d = Eigen::Matrix<double, 9, 1>;

// vec(u ⊗ v)
Vector9d Dyad(const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
  Vector9d dyad;
  for (int j = 0; j < 3; ++j) dyad.segment<3>(3 * j) = u * v[j];
  return dyad;
}

// Rows a of one matrix of entries, from node 4 kFirst to the last one, and in each group of four
// rows the columns from the group's first node on: entry_ab += Σ_j (g_a)_j right_jb.
template <int kNodes, int kGroups, int kFirst>
[[gnu::always_inline]] inline void AddRows(const double* gradient, const Four (&right)[3][kGroups],
                                           Four* entry) {
  constexpr int kEnd = std::min(4 * (kFirst + 1), kNodes);
  for (int a = 4 * kFirst; a < kEnd; ++a) {
    const double x = gradient[a], y = gradient[kNodes + a], z = gradient[2 * kNodes + a];
    Four* row = entry + a * kGroups;
    for (int b = kFirst; b < kGroups; ++b)
      row[b] += x * right[0][b] + y * right[1][b] + z * right[2][b];
  }
  if constexpr (kEnd < kNodes) AddRows<kNodes, kGroups, kFirst + 1>(gradient, right, entry);
}

// Inlined into one function for each instruction set.
template <int kNodes>
[[gnu::always_inline]] inline void AddToEntries(const double* tangent, const double* gradient,
                                                double scale, double* entry) {
  constexpr int kGroups = ElementStiffness<kNodes>::kWidth / 4;
  Four g[3][kGroups];
  for (int l = 0; l < 3; ++l) {
    const double* of_nodes = gradient + kNodes * l;
    for (int b = 0; b < kNodes / 4; ++b) LoadFour<4>(of_nodes + 4 * b, &g[l][b]);
    if constexpr (kNodes % 4 != 0)
      LoadFour<kNodes % 4>(of_nodes + kNodes - kNodes % 4, &g[l][kGroups - 1]);
    for (Four& group : g[l]) group *= scale;
  }
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 3; ++i) {
      Four right[3][kGroups];  // [j][b] = Σ_l C_ijkl (g_b)_l
      for (int j = 0; j < 3; ++j) {
        const double* C = tangent + (i + 3 * j) + 9 * k;
        for (int b = 0; b < kGroups; ++b)
          right[j][b] = C[0] * g[0][b] + C[27] * g[1][b] + C[54] * g[2][b];
      }
      AddRows<kNodes, kGroups, 0>(gradient, right,
                                  reinterpret_cast<Four*>(entry) + (i + 3 * k) * kNodes * kGroups);
    }
  }
}

}  // namespace

LACUNA_FOR_EACH_INSTRUCTION_SET
void AddToEntriesOf4(const double* tangent, const double* gradient, double scale, double* entry) {
  AddToEntries<4>(tangent, gradient, scale, entry);
}

LACUNA_FOR_EACH_INSTRUCTION_SET
void AddToEntriesOf10(const double* tangent, const double* gradient, double scale, double* entry) {
  AddToEntries<10>(tangent, gradient, scale, entry);
}

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
