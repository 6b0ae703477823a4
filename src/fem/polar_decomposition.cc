#include "fem/polar_decomposition.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "fem/target_clones.h"

namespace lacuna {
namespace {

// Convergence is quadratic: after a squared change of this size only rounding errors remain.
constexpr double kConvergedChange = 1e-17;

// Whether F is sufficiently far from singular or inverted matrices for Newton's iteration to be
// fast and accurate.
bool IsRegular(const Eigen::Matrix3d& F) {
  constexpr double kSmallestDeterminant = 1e-3;  // smallest determinant of a matrix of norm 1
  const double size = F.squaredNorm();
  return F.determinant() > kSmallestDeterminant * size * std::sqrt(size);
}

// Newton's iteration X ← ½ (γ X + X⁻ᵀ/γ) from a regular F.
bool NewtonRotation(const Eigen::Matrix3d& F, Eigen::Matrix3d* rotation) {
  constexpr int kMaxIterations = 12;
  Eigen::Matrix3d X = F;
  Eigen::Matrix3d cofactor = Cofactor(X);
  double determinant = X.col(0).dot(cofactor.col(0));
  for (int k = 0; k < kMaxIterations; ++k) {
    Eigen::Matrix3d next = 0.5 * (X + cofactor / determinant);
    const double change = (next - X).squaredNorm();
    if (change > 0.1) {
      // Far from convergence, a scale that balances X and its inverse saves iterations.
      const double scale =
          std::sqrt(std::sqrt(cofactor.squaredNorm() / X.squaredNorm()) / determinant);
      next = 0.5 * (scale * X + cofactor / (scale * determinant));
    }
    X = next;
    if (change < kConvergedChange) {
      *rotation = X;
      return true;
    }
    cofactor = Cofactor(X);
    determinant = X.col(0).dot(cofactor.col(0));
  }
  return false;
}

// Several matrices in vector lanes: entry k (column-major) of matrix i is entry[k][i].
struct MatrixLanes {
  static constexpr int kLanes = 16;
  double entry[9][kLanes];
  double change[kLanes];  // squared norm of the last change
  bool in_use[kLanes];
};

// Performs one unscaled step of Newton's iteration in all lanes.
LACUNA_FOR_EACH_INSTRUCTION_SET
void StepTowardsRotations(MatrixLanes* lanes) {
  auto& x = lanes->entry;
#pragma omp simd
  for (int i = 0; i < MatrixLanes::kLanes; ++i) {
    const double a = x[0][i], b = x[1][i], c = x[2][i], d = x[3][i], e = x[4][i], f = x[5][i],
                 g = x[6][i], h = x[7][i], k = x[8][i];
    const double ca = e * k - f * h, cb = f * g - d * k, cc = d * h - e * g;
    const double cd = h * c - k * b, ce = k * a - g * c, cf = g * b - h * a;
    const double cg = b * f - c * e, ch = c * d - a * f, ck = a * e - b * d;
    const double half_inverse = 0.5 / (a * ca + b * cb + c * cc);
    const double da = half_inverse * ca - 0.5 * a, db = half_inverse * cb - 0.5 * b,
                 dc = half_inverse * cc - 0.5 * c, dd = half_inverse * cd - 0.5 * d,
                 de = half_inverse * ce - 0.5 * e, df = half_inverse * cf - 0.5 * f,
                 dg = half_inverse * cg - 0.5 * g, dh = half_inverse * ch - 0.5 * h,
                 dk = half_inverse * ck - 0.5 * k;
    lanes->change[i] = ((da * da + db * db) + (dc * dc + dd * dd)) +
                       ((de * de + df * df) + (dg * dg + dh * dh)) + dk * dk;
    x[0][i] = a + da, x[1][i] = b + db, x[2][i] = c + dc;
    x[3][i] = d + dd, x[4][i] = e + de, x[5][i] = f + df;
    x[6][i] = g + dg, x[7][i] = h + dh, x[8][i] = k + dk;
  }
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
  if (IsRegular(F) && NewtonRotation(F, &rotation)) return rotation;
  const SignedSvd svd = ComputeSignedSvd(F);
  return svd.u * svd.v.transpose();
}

void ReplaceByRotations(int count, Eigen::Matrix3d* matrices) {
  // Sufficient without scaling for stretches between 1/8 and 8.
  constexpr int kMaxSteps = 9;
  MatrixLanes lanes;
  for (int begin = 0; begin < count; begin += MatrixLanes::kLanes) {
    Eigen::Matrix3d* group = matrices + begin;
    const int width = std::min(MatrixLanes::kLanes, count - begin);
    for (int i = 0; i < MatrixLanes::kLanes; ++i) {
      // Unused lanes and matrices that are not regular hold the identity.
      lanes.in_use[i] = i < width && IsRegular(group[i]);
      for (int k = 0; k < 9; ++k) {
        lanes.entry[k][i] = lanes.in_use[i] ? group[i].data()[k] : k % 4 == 0;
      }
    }
    for (int step = 0; step < kMaxSteps; ++step) {
      StepTowardsRotations(&lanes);
      if (*std::max_element(lanes.change, lanes.change + MatrixLanes::kLanes) < kConvergedChange) {
        break;
      }
    }
    for (int i = 0; i < width; ++i) {
      if (!lanes.in_use[i] || !(lanes.change[i] < kConvergedChange)) {
        group[i] = PolarRotation(group[i]);
        continue;
      }
      for (int k = 0; k < 9; ++k) group[i].data()[k] = lanes.entry[k][i];
    }
  }
}

}  // namespace lacuna
