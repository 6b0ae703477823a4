#include "registration/gaussian_basis.h"

#include <cmath>
#include <utility>

#include "core/parallel.h"

namespace lacuna {
namespace {

constexpr int kPointsPerTask = 256;

double KernelAt(const std::vector<KernelScale>& kernel, double squared_distance) {
  double value = 0.0;
  for (const KernelScale& scale : kernel) {
    value += scale.amplitude * std::exp(-0.5 * squared_distance / (scale.width * scale.width));
  }
  return value;
}

// The factor in ∂k/∂a = −slope · (a − p).
double KernelSlope(const std::vector<KernelScale>& kernel, double squared_distance) {
  double value = 0.0;
  for (const KernelScale& scale : kernel) {
    const double inverse = 1.0 / (scale.width * scale.width);
    value += scale.amplitude * inverse * std::exp(-0.5 * squared_distance * inverse);
  }
  return value;
}

}  // namespace

GaussianBasis::GaussianBasis(const Eigen::Matrix3Xd& points, std::vector<KernelScale> kernel,
                             double tolerance, int max_rank)
    : kernel_(std::move(kernel)) {
  const Eigen::Index n = points.cols();
  const int limit = static_cast<int>(std::min<Eigen::Index>(n, max_rank));
  Eigen::MatrixXd columns(n, limit);
  Eigen::VectorXd missed = Eigen::VectorXd::Constant(n, Variance());
  std::vector<int> chosen;
  while (static_cast<int>(chosen.size()) < limit) {
    Eigen::Index pivot;
    const double worst = missed.maxCoeff(&pivot);
    if (!(worst > tolerance * Variance())) break;
    const int k = static_cast<int>(chosen.size());
    Eigen::VectorXd column(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      column[i] = KernelAt(kernel_, (points.col(i) - points.col(pivot)).squaredNorm());
    }
    column.noalias() -= columns.leftCols(k) * columns.row(pivot).head(k).transpose();
    columns.col(k) = column / std::sqrt(worst);
    missed -= columns.col(k).cwiseAbs2();
    chosen.push_back(static_cast<int>(pivot));
  }
  const int rank = static_cast<int>(chosen.size());
  pivots_.resize(3, rank);
  factor_.setZero(rank, rank);
  for (int k = 0; k < rank; ++k) {
    pivots_.col(k) = points.col(chosen[k]);
    factor_.row(k).head(k + 1) = columns.row(chosen[k]).head(k + 1);
  }
}

double GaussianBasis::Variance() const { return KernelAt(kernel_, 0.0); }

bool GaussianBasis::IsFine() const {
  // L_KK² / k(y, y) of the last function. The rounding error of k is magnified by up to 300, so
  // that φ is accurate to 2e-5.
  constexpr double kSmallestShare = 1e-5;
  if (Rank() == 0) return false;
  const double smallest = factor_(Rank() - 1, Rank() - 1);
  return smallest * smallest < kSmallestShare * Variance();
}

GaussianBasis GaussianBasis::Leading(int rank) const {
  GaussianBasis leading;
  leading.kernel_ = kernel_;
  leading.pivots_ = pivots_.leftCols(rank);
  leading.factor_ = factor_.topLeftCorner(rank, rank);
  return leading;
}

Eigen::Matrix3Xd GaussianBasis::KernelWeights(const Eigen::Matrix3Xd& coefficients) const {
  return factor_.triangularView<Eigen::Lower>().solve<Eigen::OnTheRight>(coefficients);
}

Eigen::Matrix3Xd GaussianBasis::FromKernelSpace(const Eigen::Matrix3Xd& sums) const {
  return factor_.transpose().triangularView<Eigen::Upper>().solve<Eigen::OnTheRight>(sums);
}

Eigen::MatrixXd GaussianBasis::Values(const Eigen::Matrix3Xd& points) const {
  Eigen::MatrixXd values(Rank(), points.cols());
  ParallelBlocks(points.cols(), kPointsPerTask, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      for (int k = 0; k < Rank(); ++k) {
        values(k, i) = KernelAt(kernel_, (points.col(i) - pivots_.col(k)).squaredNorm());
      }
    }
    auto part = values.middleCols(begin, end - begin);
    factor_.triangularView<Eigen::Lower>().solveInPlace(part);
  });
  return values;
}

void GaussianBasis::Gradients(const Eigen::Matrix3Xd& points, Eigen::MatrixXd gradient[3]) const {
  for (int axis = 0; axis < 3; ++axis) gradient[axis].resize(Rank(), points.cols());
  ParallelBlocks(points.cols(), kPointsPerTask, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      for (int k = 0; k < Rank(); ++k) {
        const Eigen::Vector3d offset = points.col(i) - pivots_.col(k);
        const Eigen::Vector3d slope = -KernelSlope(kernel_, offset.squaredNorm()) * offset;
        for (int axis = 0; axis < 3; ++axis) gradient[axis](k, i) = slope[axis];
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      auto part = gradient[axis].middleCols(begin, end - begin);
      factor_.triangularView<Eigen::Lower>().solveInPlace(part);
    }
  });
}

}  // namespace lacuna
