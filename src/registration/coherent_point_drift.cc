#include "registration/coherent_point_drift.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "registration/drift.h"
#include "registration/gaussian_basis.h"
#include "registration/registration_level.h"

namespace lacuna {
namespace {

CpdResult Failure(CpdStatus status, std::string message) {
  CpdResult result;
  result.status = status;
  result.message = std::move(message);
  return result;
}

std::optional<CpdResult> Refusal(const char* name, const PointCloud& cloud) {
  if (cloud.Size() < CpdResult::kFewestPoints) {
    return Failure(CpdStatus::kTooFewPoints,
                   fmt::format("too few points: the {} has {}, and {} are needed", name,
                               cloud.Size(), CpdResult::kFewestPoints));
  }
  if (!cloud.points.allFinite() || !cloud.normals.allFinite()) {
    return Failure(CpdStatus::kNotFinite,
                   fmt::format("the {} has coordinates or normals that are not finite", name));
  }
  return std::nullopt;
}

// Twice the 70 % quantile of the source points' distances to the target: large enough to reach the
// corresponding points, yet insensitive to parts that the target lacks.
double InitialSigma(const Eigen::Matrix3Xf& source, const Eigen::Matrix3Xf& target) {
  constexpr int kEvery = 4;
  constexpr double kShare = 0.7;
  std::vector<float> distance;
  for (Eigen::Index i = 0; i < source.cols(); i += kEvery) {
    distance.push_back((target.colwise() - source.col(i)).colwise().squaredNorm().minCoeff());
  }
  const auto chosen = distance.begin() + static_cast<int>(kShare * distance.size());
  std::nth_element(distance.begin(), chosen, distance.end());
  return 2.0 * std::sqrt(static_cast<double>(*chosen));
}

// A sample of the source with a spacing well below the width of the kernel.
Eigen::Matrix3Xd BasisSample(const Eigen::Matrix3Xd& source) {
  constexpr int kSample = 1000;
  int stride = 1;
  while (source.cols() >= 2 * stride * kSample) stride *= 2;
  return EveryNth(source, stride);
}

GaussianBasis MakeBasis(const Eigen::Matrix3Xd& source, const CpdOptions& options) {
  std::vector<KernelScale> kernel = {{options.beta, 1.0}};
  if (options.fine_variance > 0.0) kernel.push_back({options.fine_beta, options.fine_variance});
  constexpr int kLeastRank = 4;
  const int affordable = static_cast<int>(source.cols()) / options.points_per_function;
  return GaussianBasis(BasisSample(source), kernel, options.rank_tolerance,
                       std::clamp(affordable, kLeastRank, options.max_rank));
}

// The coefficients of the least-squares fit to `displacement` at the points of `sample`.
Eigen::Matrix3Xd Coefficients(const GaussianBasis& basis, const Eigen::Matrix3Xd& sample,
                              const Eigen::Matrix3Xd& displacement) {
  const Eigen::MatrixXd values = basis.Values(sample);
  Eigen::MatrixXd gram = values * values.transpose();
  constexpr double kRidge = 1e-6;
  gram.diagonal().array() += kRidge * static_cast<double>(sample.cols());
  return gram.llt().solve(values * displacement.transpose()).transpose();
}

// The coefficients at the start: those of the previous field, of the match of extents, or zero.
Eigen::Matrix3Xd FirstCoefficients(const GaussianBasis& basis, const NormalisedClouds& clouds,
                                   const CpdOptions& options, const DisplacementField* previous) {
  const Eigen::Matrix3Xd sample = BasisSample(clouds.source);
  if (previous != nullptr) {
    const Eigen::Matrix3Xd places = (clouds.scale * sample).colwise() + clouds.centre;
    return Coefficients(basis, sample, previous->Evaluate(places) / clouds.scale);
  }
  if (options.match_extents) {
    // In this frame the source's mean is 0 and its size 1.
    const Eigen::Vector3d mean = clouds.target.rowwise().mean();
    const double size = std::sqrt((clouds.target.colwise() - mean).squaredNorm() /
                                  static_cast<double>(clouds.target.cols()));
    return Coefficients(basis, sample, ((size - 1.0) * sample).colwise() + mean);
  }
  return Eigen::Matrix3Xd::Zero(3, basis.Rank());
}

std::vector<Level> MakeLevels(const NormalisedClouds& clouds, double sigma_floor) {
  const Eigen::Index sources = clouds.source.cols(), targets = clouds.target.cols();
  const Eigen::Index larger = std::max(sources, targets);
  const double sparser =
      std::max(1.0, std::sqrt(static_cast<double>(sources) / static_cast<double>(targets)));
  std::vector<Level> levels;
  for (const int stride : LevelStrides(larger)) {
    Level level;
    level.source_stride = StrideFor(sources, larger, stride);
    level.target_stride = StrideFor(targets, larger, stride);
    level.floor = sigma_floor * sparser * clouds.source_spacing *
                  std::sqrt(static_cast<double>(level.source_stride));
    level.is_last = stride == 1;
    levels.push_back(level);
  }
  return levels;
}

CpdResult MakeResult(const PointCloud& source, const NormalisedClouds& clouds,
                     const GaussianBasis& basis, const CpdOptions& options, const Drift& drift) {
  CpdResult result;
  result.status = drift.converged ? CpdStatus::kConverged : CpdStatus::kNoConvergence;
  result.message = drift.converged
                       ? fmt::format("converged after {} iterations", drift.iterations)
                       : fmt::format("no convergence in {} iterations on the last level",
                                     options.max_iterations);
  result.iterations = drift.iterations;
  result.rank = basis.Rank();
  result.outlier_weight = drift.outlier_weight;
  const double prior_variance =
      drift.prior_scale / (options.lambda * static_cast<double>(clouds.target.cols()));
  result.field = DisplacementField(clouds.centre, clouds.scale, basis, drift.coefficients,
                                   drift.covariance, 3.0 * prior_variance);
  result.displaced.resize(3, source.Size());
  result.weight.resize(source.Size());
  for (Eigen::Index i = 0; i < source.Size(); ++i) {
    const int place = clouds.source_order[i];
    result.displaced.col(place) =
        source.points.col(place) + clouds.scale * drift.displacement.col(i).cast<double>();
    result.weight[place] = drift.posterior.weight[i];
  }
  result.inlier.resize(clouds.target.cols());
  for (Eigen::Index i = 0; i < clouds.target.cols(); ++i) {
    result.inlier[clouds.target_order[i]] = drift.posterior.inlier[i];
  }
  return result;
}

}  // namespace

CpdResult RegisterNonrigid(const PointCloud& source, const PointCloud& target,
                           const CpdOptions& options, const DisplacementField* warm_start) {
  CHECK(options.kernels != nullptr);
  CHECK_GT(options.beta, 0.0);
  CHECK_GE(options.fine_variance, 0.0);
  CHECK(options.fine_variance == 0.0 || options.fine_beta > 0.0);
  CHECK_GT(options.lambda, 0.0);
  CHECK_GE(options.rigidity, 0.0);
  CHECK_GT(options.tangential_weight, 0.0);
  CHECK_LE(options.tangential_weight, 1.0);
  CHECK_GE(options.outlier_weight, CpdOptions::kFewestOutliers);
  CHECK_LE(options.outlier_weight, CpdOptions::kMostOutliers);
  CHECK_GE(options.initial_sigma, 0.0);
  CHECK_GT(options.sigma_floor, 0.0);
  CHECK_GT(options.cutoff, 0.0);
  CHECK_GT(options.points_per_function, 0);
  CHECK_GE(options.max_rank, 4);
  CHECK_GT(options.rank_tolerance, 0.0);
  CHECK_LE(options.rank_tolerance, 1.0);
  CHECK_GE(options.tolerance, 0.0);
  CHECK_GE(options.max_iterations, 1);
  if (const auto refusal = Refusal("source", source)) return *refusal;
  if (const auto refusal = Refusal("target", target)) return *refusal;
  const NormalisedClouds clouds = Normalise(source, target, *options.kernels);
  if (!(clouds.source_spacing > 0.0)) {
    return Failure(CpdStatus::kNoExtent,
                   "the source has no extent: its points do not span a surface");
  }
  const GaussianBasis basis = MakeBasis(clouds.source, options);
  const std::vector<Level> levels = MakeLevels(clouds, options.sigma_floor);
  const bool is_warm = warm_start != nullptr && !warm_start->IsEmpty();

  Drift drift;
  drift.outlier_weight = options.outlier_weight;
  drift.coefficients = FirstCoefficients(basis, clouds, options, is_warm ? warm_start : nullptr);
  if (options.initial_sigma > 0.0) {
    drift.sigma = options.initial_sigma / clouds.scale;
  } else {
    // A warm start is assessed with all target points, because the gaps of a coarse sample would
    // hide how good it is.
    const Eigen::Matrix3Xd rest = EveryNth(clouds.source, levels.front().source_stride);
    drift.sigma = InitialSigma(
        (rest + drift.coefficients * basis.Values(rest)).cast<float>(),
        EveryNth(clouds.target, is_warm ? 1 : levels.front().target_stride).cast<float>());
  }
  for (const Level& level : levels) {
    // A level coarser than the accuracy of a warm start would only deteriorate it.
    if (is_warm && !level.is_last && drift.sigma < level.floor) continue;
    drift.sigma = std::max(drift.sigma, level.floor);
    constexpr int kCoarseRank = 40;
    const int rank = level.is_last ? basis.Rank() : std::min(kCoarseRank, basis.Rank());
    RunLevel(clouds, level, basis.Leading(rank), options, &drift);
    if (!drift.has_overlap) {
      return Failure(CpdStatus::kNoOverlap,
                     "no overlap: almost no target point belongs to the source");
    }
  }
  return MakeResult(source, clouds, basis, options, drift);
}

}  // namespace lacuna
