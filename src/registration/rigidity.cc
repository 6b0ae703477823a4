#include "registration/rigidity.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace lacuna {

Patches MakePatches(const GaussianBasis& basis, const Eigen::Matrix3Xd& points) {
  constexpr int kFewestPatches = 400;
  const Eigen::Index count = points.cols();
  Patches patches;
  patches.is_fine = basis.IsFine();
  while (!patches.is_fine && count >= 2 * patches.size * kFewestPatches) patches.size *= 2;
  const Eigen::Index patch_count = (count + patches.size - 1) / patches.size;

  // The mean of φ over a patch is estimated from about four of its points.
  constexpr int kSamples = 4;
  const int stride = std::max(1, patches.size / kSamples);
  Eigen::Matrix3Xd centres(3, patch_count);
  std::vector<Eigen::Index> first(patch_count + 1, 0);
  std::vector<Eigen::Index> sampled;
  for (Eigen::Index q = 0; q < patch_count; ++q) {
    const Eigen::Index begin = q * patches.size, end = std::min(count, begin + patches.size);
    centres.col(q) = points.middleCols(begin, end - begin).rowwise().mean();
    for (Eigen::Index i = begin; i < end; i += stride) sampled.push_back(i);
    first[q + 1] = static_cast<Eigen::Index>(sampled.size());
  }
  Eigen::Matrix3Xd samples(3, sampled.size());
  for (size_t i = 0; i < sampled.size(); ++i) samples.col(i) = points.col(sampled[i]);
  const Eigen::MatrixXd values = basis.Values(samples);
  patches.mean_basis.resize(basis.Rank(), patch_count);
  for (Eigen::Index q = 0; q < patch_count; ++q) {
    patches.mean_basis.col(q) =
        values.middleCols(first[q], first[q + 1] - first[q]).rowwise().mean();
  }
  basis.Gradients(centres, patches.gradient);
  return patches;
}

std::vector<Eigen::Matrix3d> DeformationGradients(const Patches& patches,
                                                  const Eigen::Matrix3Xd& coefficients) {
  std::vector<Eigen::Matrix3d> f(patches.Count(), Eigen::Matrix3d::Identity());
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Matrix3Xd slope = coefficients * patches.gradient[axis];
    for (int q = 0; q < patches.Count(); ++q) f[q].col(axis) += slope.col(q);
  }
  return f;
}

Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& f) {
  Eigen::Matrix3d rotation = f;
  constexpr int kMaxIterations = 30;
  for (int k = 0; k < kMaxIterations; ++k) {
    // A reflected or collapsed patch has no meaningful rotation.
    if (!(rotation.determinant() > 1e-6)) return Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d next = 0.5 * (rotation + rotation.inverse().transpose());
    const double change = (next - rotation).squaredNorm();
    rotation = next;
    if (change < 1e-16) break;
  }
  return rotation;
}

Eigen::Matrix3Xd RigidityGradient(const Patches& patches,
                                  const std::vector<Eigen::Matrix3d>& deformation_gradients) {
  const int count = patches.Count();
  Eigen::Matrix3Xd strain[3];
  for (Eigen::Matrix3Xd& s : strain) s.resize(3, count);
  constexpr int kPatchesPerTask = 64;
  ParallelFor(count, kPatchesPerTask, [&](int64_t q) {
    const Eigen::Matrix3d& f = deformation_gradients[q];
    const Eigen::Matrix3d difference = f - NearestRotation(f);
    for (int axis = 0; axis < 3; ++axis) strain[axis].col(q) = difference.col(axis);
  });
  Eigen::Matrix3Xd gradient = Eigen::Matrix3Xd::Zero(3, patches.mean_basis.rows());
  for (int axis = 0; axis < 3; ++axis) {
    gradient.noalias() += strain[axis] * patches.gradient[axis].transpose() / count;
  }
  return gradient;
}

Eigen::MatrixXd RigidityHessian(const Patches& patches) {
  constexpr double kFixedRotations = 0.05;
  const Eigen::Index rank = patches.mean_basis.rows();
  // The Hessian only affects the speed of convergence, so single precision and a subset of the
  // patches are sufficient.
  constexpr Eigen::Index kEnoughPatches = 200;
  const Eigen::Index stride = std::max<Eigen::Index>(1, patches.Count() / kEnoughPatches);
  const Eigen::Index count = (patches.Count() + stride - 1) / stride;
  Eigen::MatrixXf gradient[3];
  for (int axis = 0; axis < 3; ++axis) {
    gradient[axis].resize(rank, count);
    for (Eigen::Index q = 0; q < count; ++q) {
      gradient[axis].col(q) = patches.gradient[axis].col(q * stride).cast<float>();
    }
  }
  // products[a][b](i, j): the mean over the patches of ∂_a φ_i ∂_b φ_j
  Eigen::MatrixXd products[3][3];
  static constexpr int kPairs[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
  ParallelFor(6, 1, [&](int64_t pair) {
    const int a = kPairs[pair][0], b = kPairs[pair][1];
    const Eigen::MatrixXf product =
        gradient[a] * gradient[b].transpose() / static_cast<float>(count);
    products[a][b] = product.cast<double>();
    if (a != b) products[b][a] = products[a][b].transpose();
  });
  const Eigen::MatrixXd full = products[0][0] + products[1][1] + products[2][2];
  // |sym δF|² = (|δF|² + tr δF²)/2
  Eigen::MatrixXd hessian(3 * rank, 3 * rank);
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      auto block = hessian.block(a * rank, b * rank, rank, rank);
      block = 0.5 * (1.0 - kFixedRotations) * products[b][a];
      if (a == b) block += 0.5 * (1.0 + kFixedRotations) * full;
    }
  }
  return hessian;
}

}  // namespace lacuna
