#include "registration/surface_normals.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/median.h"
#include "core/parallel.h"

namespace lacuna {
namespace {

// The square root of the area per point of a block. Points spread evenly over a square of side b
// have the variance b²/12 along both sides, so the geometric mean of the two largest variances
// gives the area. 0 for a degenerate block.
double BlockSpacing(const QueryBlock& block, int count) {
  if (count < 3) return 0.0;
  Eigen::Matrix3Xd points(3, count);
  for (int i = 0; i < count; ++i) points.col(i) << block.x[i], block.y[i], block.z[i];
  const Eigen::Matrix3Xd centred = points.colwise() - points.rowwise().mean().eval();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
  axes.computeDirect(centred * centred.transpose() / count, Eigen::EigenvaluesOnly);
  const Eigen::Vector3d variance = axes.eigenvalues().cwiseMax(0.0);
  constexpr double kLine = 1e-8;  // relative variance across a line due to single precision
  if (!(variance[1] > kLine * variance[2])) return 0.0;
  return std::sqrt(12.0 * std::sqrt(variance[1] * variance[2]) / count);
}

int CountIn(const BlockTree& cloud, int block) {
  return std::min(kQueryBlock, cloud.Size() - block * kQueryBlock);
}

}  // namespace

double SurfaceSpacing(const BlockTree& cloud) {
  std::vector<double> spacing;
  for (int block = 0; block < cloud.QueryBlockCount(); ++block) {
    const double s = BlockSpacing(cloud.Queries(block), CountIn(cloud, block));
    if (s > 0.0) spacing.push_back(s);
  }
  return spacing.empty() ? 0.0 : Median(std::move(spacing));
}

Eigen::Matrix3Xd EstimateNormals(const BlockTree& cloud, const GaussianKernels& kernels) {
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, cloud.Size());
  constexpr int kBlocksPerTask = 16;
  ParallelBlocks(cloud.QueryBlockCount(), kBlocksPerTask, [&](int64_t begin, int64_t end) {
    std::vector<int> leaves;
    for (int64_t b = begin; b < end; ++b) {
      const int block = static_cast<int>(b);
      const double width = 1.5 * BlockSpacing(cloud.Queries(block), CountIn(cloud, block));
      if (!(width > 0.0)) continue;
      const float reach = static_cast<float>(2.5 * width);
      cloud.LeavesWithin(cloud.QueryBox(block), reach, &leaves);
      MomentBlock sums;
      kernels.moment_sums(
          cloud.Queries(block),
          {cloud.Candidates(), leaves.data(), static_cast<int>(leaves.size())},
          {static_cast<float>(0.5 / (width * width * std::numbers::ln2)), reach * reach}, &sums);
      for (int i = 0; i < CountIn(cloud, block); ++i) {
        const auto m = [&](int k) {
          return static_cast<double>(sums.moment[k][i]) / sums.moment[0][i];
        };
        const Eigen::Vector3d mean(m(1), m(2), m(3));
        Eigen::Matrix3d covariance;
        covariance << m(4), m(5), m(6), m(5), m(7), m(8), m(6), m(8), m(9);
        covariance -= mean * mean.transpose();
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
        axes.computeDirect(covariance);
        const Eigen::Vector3d variance = axes.eigenvalues();
        if (!(variance[1] > 1e-3 * variance[2]) || !(variance[2] > 0.0)) continue;
        normals.col(block * kQueryBlock + i) = axes.eigenvectors().col(0);
      }
    }
  });
  return normals;
}

}  // namespace lacuna
