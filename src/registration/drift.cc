#include "registration/drift.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "registration/basis_table.h"
#include "registration/block_tree.h"
#include "registration/motion_step.h"
#include "registration/rigidity.h"

namespace lacuna {
namespace {

// The volume over which outliers are uniformly distributed: the target's bounding box, with a
// minimum thickness for a flat target.
double OutlierVolume(const Eigen::Matrix3Xd& target) {
  const Eigen::Vector3d extent = target.rowwise().maxCoeff() - target.rowwise().minCoeff();
  constexpr double kLeastThickness = 0.1;
  return extent.cwiseMax(kLeastThickness * std::max(extent.maxCoeff(), 1e-3)).prod();
}

// The curvature bias b / σ² of motion_step.h, measured with the σ given.
Eigen::VectorXd CurvatureBias(const Eigen::Matrix3Xf& points, const Eigen::Matrix3Xd& normals,
                              double sigma, const CpdOptions& options) {
  const BlockTree queries(points);
  BlockTree candidates(points);
  const Posterior self =
      ComputePosterior(queries, {sigma, 0.0, 1.0, options.cutoff}, *options.kernels, &candidates);
  return self.shift.cast<double>().cwiseProduct(normals).colwise().sum().transpose() /
         (sigma * sigma);
}

// The Cholesky factor of a Hessian (lower half) that is positive definite except for rounding
// errors of its summation in single precision.
Eigen::LLT<Eigen::MatrixXd> Factor(Eigen::MatrixXd hessian) {
  Eigen::LLT<Eigen::MatrixXd> factor(hessian.selfadjointView<Eigen::Lower>());
  for (double shift = 1e-7; factor.info() != Eigen::Success && shift < 1.0; shift *= 10.0) {
    hessian.diagonal().array() += shift * hessian.diagonal().maxCoeff();
    factor.compute(hessian.selfadjointView<Eigen::Lower>());
  }
  return factor;
}

// The factor by which the variance of the motion prior must be scaled to make the motion found a
// typical one: s² = N (λ |c|² + 2 μ E(c)) / 3K, the mean of a χ² distribution (empirical Bayes).
// Without it the uncertainty in directions that the data do not determine would not scale with the
// size of the motion.
double PriorScale(const Patches& patches, const Eigen::Matrix3Xd& coefficients, double target_count,
                  const CpdOptions& options) {
  double strain = 0.0;
  for (const Eigen::Matrix3d& f : DeformationGradients(patches, coefficients)) {
    strain += (f - NearestRotation(f)).squaredNorm() / patches.Count();
  }
  const double energy = options.lambda * coefficients.squaredNorm() + options.rigidity * strain;
  constexpr double kStillPrior = 1e-4;  // even a vanishing motion keeps some uncertainty
  return std::max(kStillPrior, target_count * energy / static_cast<double>(coefficients.size()));
}

// The covariance of the coefficients, summed over the axes (K × K): the inverse Hessian of the
// negative log posterior with the estimated prior variance. The objective is σ² times that
// posterior.
Eigen::MatrixXd Covariance(const SourceSurface& surface, const Pull& pull,
                           const Eigen::MatrixXd& rigidity_hessian, double sigma,
                           double target_count, double prior_scale, const CpdOptions& options) {
  const double prior = sigma * sigma * target_count / prior_scale;
  const MotionObjective objective = {options.tangential_weight, prior * options.lambda,
                                     prior * options.rigidity};
  const Eigen::LLT<Eigen::MatrixXd> hessian =
      Factor(MotionHessian(surface, pull, rigidity_hessian, objective));
  const Eigen::Index rank = rigidity_hessian.rows() / 3;
  const Eigen::MatrixXd inverse = hessian.solve(Eigen::MatrixXd::Identity(3 * rank, 3 * rank));
  return sigma * sigma *
         (inverse.topLeftCorner(rank, rank) + inverse.block(rank, rank, rank, rank) +
          inverse.bottomRightCorner(rank, rank));
}

// Within the surface Σ p |d|² / Σ p equals 2 σ² for any σ. Subtracting it gives the variance along
// the normal, which estimates σ² in a few steps. As far as distances within the surface count (ε),
// Myronenko & Song's mean over the three axes is used instead.
double NormalVariance(const Posterior& posterior, double sigma) {
  return std::max(0.0, posterior.total_spread / posterior.total_weight - 2.0 * sigma * sigma);
}
double IsotropicVariance(const Posterior& posterior) {
  return posterior.total_spread / (3.0 * posterior.total_weight);
}
double NextSigma(const Posterior& posterior, double sigma, double tangential_weight) {
  const double next = std::sqrt((1.0 - tangential_weight) * NormalVariance(posterior, sigma) +
                                tangential_weight * IsotropicVariance(posterior));
  constexpr double kFastest = 0.7;
  return std::clamp(next, kFastest * sigma, sigma);
}

// The variance τ² that weights the prior against the data. It follows the residuals along the
// normals rather than σ², which cannot fall below the point spacing: clean scans get less and noisy
// scans more prior than σ² would give them. As far as distances within the surface count (ε),
// Myronenko & Song's variance without the lower bound is used instead.
double PriorVariance(const Posterior& posterior, double sigma, double residual,
                     double tangential_weight) {
  // The ratio residual / σ is about 0.06 for clean scans and 0.2 for noisy ones.
  constexpr double kResidualShare = 8.0;
  constexpr double kLeast = 0.05, kMost = 4.0;
  constexpr double kLeastIsotropic = 1e-4;
  const double variance = sigma * sigma;
  const double directed = variance * std::clamp(kResidualShare * residual / sigma, kLeast, kMost);
  const double isotropic =
      std::clamp(IsotropicVariance(posterior), kLeastIsotropic * variance, variance);
  return (1.0 - tangential_weight) * directed + tangential_weight * isotropic;
}

// The surface of the source at this level; `rest` holds its points.
SourceSurface SurfaceOf(const NormalisedClouds& clouds, const Level& level,
                        const GaussianBasis& basis, const CpdOptions& options,
                        const Eigen::Matrix3Xd& rest) {
  // The bias is measured with this multiple of the lower limit of σ, which is small but covers some
  // neighbours. Larger values average over more neighbours, and smooth sharp bends.
  constexpr double kBiasSigma = 1.5;
  SourceSurface surface;
  surface.normals = EveryNth(clouds.source_normals, level.source_stride);
  surface.curvature_bias =
      CurvatureBias(rest.cast<float>(), surface.normals, kBiasSigma * level.floor, options);
  surface.patches = MakePatches(basis, rest);
  return surface;
}

// Whether enough of the target is explained by the source, rather than as outliers, for a motion to
// be estimated.
bool HasOverlap(const Posterior& posterior, double target_count) {
  // A rigid motion needs three points. Larger values give up on targets that show little of the
  // source; smaller ones estimate a motion from points that belong to it by chance.
  constexpr double kFewestPoints = 3.0, kLeastShare = 0.01;
  return posterior.total_weight > std::max(kFewestPoints, kLeastShare * target_count);
}

// Whether the factor of a Hessian, computed with `factor_sigma` and used for `age` steps, must be
// computed anew. The Hessian only affects the speed of convergence, so a factor is reused for a few
// steps. This does not hold for a fine basis, where a single newly matched point can dominate the
// curvature of a function.
bool IsOutdated(double factor_sigma, int age, double sigma, bool is_fine) {
  // Larger values save factorisations, and cost steps that converge more slowly.
  constexpr int kOldest = 4;              // steps
  constexpr double kLargestChange = 0.1;  // of σ, relative
  return age == (is_fine ? 1 : kOldest) || std::abs(sigma - factor_sigma) > kLargestChange * sigma;
}

}  // namespace

void RunLevel(const NormalisedClouds& clouds, const Level& level, const GaussianBasis& basis,
              const CpdOptions& options, Drift* drift) {
  const Eigen::Matrix3Xd rest = EveryNth(clouds.source, level.source_stride);
  const Eigen::Matrix3Xf rest_single = rest.cast<float>();
  BlockTree source(rest_single);
  BlockTree target(EveryNth(clouds.target, level.target_stride).cast<float>());
  const double target_count = static_cast<double>(target.Size());
  const double volume = OutlierVolume(clouds.target);
  const double spacing =
      clouds.source_spacing * std::sqrt(static_cast<double>(level.source_stride));
  // The next level continues from a coarse one, which need not be exact. Larger: fewer steps here,
  // but more on the next level, where each costs more.
  constexpr double kCoarseTolerance = 10.0;
  const double tolerance =
      (level.is_last ? 1.0 : kCoarseTolerance) * options.tolerance * options.sigma_floor * spacing;
  // A level ends only where σ, too, has settled: where it falls by less than this factor per step.
  constexpr double kSettledSigma = 0.97;

  const BasisTable table(basis, source, *options.kernels);
  const SourceSurface surface = SurfaceOf(clouds, level, basis, options, rest);
  const Eigen::MatrixXd rigidity_hessian = RigidityHessian(surface.patches);

  const int rank = basis.Rank();
  Eigen::Matrix3Xd coefficients = drift->coefficients.leftCols(rank);
  Eigen::Matrix3Xf displacement = table.Expand(coefficients);
  MotionObjective objective;
  Pull pull;
  Eigen::LLT<Eigen::MatrixXd> hessian;
  double factor_sigma = 0.0;
  int factor_age = 0;
  double sigma = drift->sigma;
  drift->converged = false;
  for (int k = 0; k < options.max_iterations && !drift->converged; ++k) {
    ++drift->iterations;
    sigma = drift->sigma;
    source.Move(rest_single + displacement);
    drift->posterior = ComputePosterior(
        source, {sigma, drift->outlier_weight, volume, options.cutoff}, *options.kernels, &target);
    drift->has_overlap = HasOverlap(drift->posterior, target_count);
    if (!drift->has_overlap) return;

    const std::vector<Eigen::Matrix3d> gradients =
        DeformationGradients(surface.patches, coefficients);
    objective.tangential_weight = options.tangential_weight;
    pull = PullOf(surface, gradients, drift->posterior, sigma, objective);
    const double prior = target_count * PriorVariance(drift->posterior, sigma, pull.residual,
                                                      options.tangential_weight);
    objective.coherence = prior * options.lambda;
    objective.rigidity = prior * options.rigidity;
    if (IsOutdated(factor_sigma, factor_age, sigma, basis.IsFine())) {
      factor_sigma = sigma;
      factor_age = 0;
      hessian = Factor(MotionHessian(surface, pull, rigidity_hessian, objective));
    }
    ++factor_age;
    coefficients += MotionStep(surface, table, pull, coefficients, gradients, objective, hessian);
    const Eigen::Matrix3Xf moved = table.Expand(coefficients);
    const double change =
        std::sqrt((moved - displacement).squaredNorm() / static_cast<double>(rest.cols()));
    displacement = moved;

    drift->sigma =
        std::max(level.floor, NextSigma(drift->posterior, sigma, options.tangential_weight));
    if (options.estimate_outlier_weight) {
      drift->outlier_weight = std::clamp(1.0 - drift->posterior.total_weight / target_count,
                                         CpdOptions::kFewestOutliers, CpdOptions::kMostOutliers);
    }
    drift->converged = drift->sigma > kSettledSigma * sigma && change < tolerance;
  }
  drift->coefficients.leftCols(rank) = coefficients;
  if (!level.is_last) return;
  drift->displacement = displacement;
  drift->prior_scale = PriorScale(surface.patches, coefficients, target_count, options);
  drift->covariance =
      Covariance(surface, pull, rigidity_hessian, sigma, target_count, drift->prior_scale, options);
}

}  // namespace lacuna
