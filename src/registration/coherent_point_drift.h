// Non-rigid Coherent Point Drift: the smooth displacement that carries one cloud onto another.
//
// Myronenko & Song, "Point Set Registration: Coherent Point Drift", IEEE TPAMI 2010: the target is
// taken for a sample of Gaussians that sit on the moved source; EM alternates between the
// probabilities of the pairs (posterior.h) and the motion (motion_step.h). What differs from the
// paper, and why:
//  - the kernel has low rank and is a function of space (gaussian_basis.h), so that the result is
//    a field that can be evaluated anywhere, and memory is linear in the number of points;
//  - pairs farther apart than a few σ are left out, in both sums alike;
//  - residuals count along the normals of the source, hardly within its surface: two scans of one
//    surface have no points in common, and within the surface plain CPD matches their densities;
//  - the motion within the surface is decided by a strain energy beside motion coherence
//    (rigidity.h); both grow with the number of target points and with the noise that is found;
//  - σ² is estimated from the distances along the normals, which converges in a few steps, and has
//    a floor at the spacing of the points; the share of outliers is estimated too;
//  - nested samples of both clouds, from coarse to fine, share one set of coefficients.
#ifndef LACUNA_REGISTRATION_COHERENT_POINT_DRIFT_H_
#define LACUNA_REGISTRATION_COHERENT_POINT_DRIFT_H_

#include <Eigen/Core>
#include <functional>
#include <string>

#include "geometry/point_cloud.h"
#include "registration/displacement_field.h"
#include "registration/gaussian_sums.h"

namespace lacuna {

// What a caller may show while it waits, once per iteration.
struct CpdProgress {
  int iteration = 0;    // from 1, over all levels
  int points = 0;       // source points of the present level
  int all_points = 0;   // source points of the last level
  double sigma = 0.0;   // m
  double change = 0.0;  // rms displacement of this iteration, m
};

// "Size" is the rms distance of the source's points from their mean.
struct CpdOptions {
  // Width of the kernel, sizes. Raise: stiffer, fewer functions, missing parts follow from afar.
  double beta = 1.5;
  // Width and variance (of that of the first) of a second Gaussian in the kernel, for local dents.
  // Raise the variance: more local detail, more freedom to follow noise. 0: the one Gaussian.
  double fine_beta = 0.4;
  double fine_variance = 0.02;
  // Weight of motion coherence per target point. Raise: smaller and smoother motions.
  double lambda = 0.01;
  // Weight of strain per target point. Raise: the surface stretches and shears less. 0: plain CPD.
  double rigidity = 5.0;
  // How much a distance within the surface counts, of one along its normal, 0 … 1. Raise where
  // source and target hold the same points (tracked markers): 1 is plain CPD.
  double tangential_weight = 0.003;
  // Start with the source moved onto the mean of the target and scaled to its size, where source
  // and target both show all of the body; else in place. A warm start comes before it.
  bool match_extents = false;
  // Probability that a target point belongs to nothing: at first, or throughout.
  double outlier_weight = 0.1;
  bool estimate_outlier_weight = true;
  // σ at the start, m; 0: from the distances between the clouds. Raise for larger motions.
  double initial_sigma = 0.0;
  // Lower end of σ, spacings of the sparser cloud. Raise: smoother, but small features are lost.
  double sigma_floor = 0.7;
  // Where the Gaussians end, σ. Raise: slower, and closer to the sums without an end.
  double cutoff = 3.5;
  // Functions of the basis: at most so many, at most one per so many source points, and no more
  // than leave this share of the kernel's variance unexplained. More functions: finer and slower.
  int max_rank = 64;
  int points_per_function = 40;
  double rank_tolerance = 1e-4;
  // Converged when an iteration moves the points by less than this (rms), in sigma_floor spacings
  // of the source. Raise: fewer iterations.
  double tolerance = 0.0057;
  int max_iterations = 60;  // per level
  std::function<void(const CpdProgress&)> progress;
  // The kernels to use; at first the fastest that the processor has.
  const GaussianKernels* kernels = &BestKernels();
};

enum class CpdStatus {
  kNotRun,
  kConverged,
  kNoConvergence,  // after max_iterations on the last level: the field is the last iterate
  kTooFewPoints,   // fewer than CpdResult::kFewestPoints in one of the clouds
  kNotFinite,      // a coordinate or a normal is NaN or infinite
  kNoExtent,       // all source points in one place
  kNoOverlap,      // hardly a target point belongs to the source
};

struct CpdResult {
  static constexpr int kFewestPoints = 8;

  CpdStatus status = CpdStatus::kNotRun;
  std::string message = "not run";
  bool IsUsable() const { return status == CpdStatus::kConverged; }

  DisplacementField field;
  Eigen::Matrix3Xd displaced;   // 3 × M, m: the source's points carried by the field
  Eigen::VectorXd weight;       // M: target points that each source point explains, Σ_n p_mn
  Eigen::VectorXd inlier;       // N: probability that each target point belongs to the source
  double sigma = 0.0;           // m
  double noise = 0.0;           // m: rms distance of target points along the normals
  double outlier_weight = 0.0;  // share of the target that belongs to nothing
  int iterations = 0;           // over all levels
  int rank = 0;                 // functions of the basis
};

// Carries `source` onto `target`. Normals of the source are used where given and else estimated
// from its points; those of the target are not used. A previous field on about the same object,
// such as that of the last frame, may serve as the start.
CpdResult RegisterNonrigid(const PointCloud& source, const PointCloud& target,
                           const CpdOptions& options = {},
                           const DisplacementField* warm_start = nullptr);

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_COHERENT_POINT_DRIFT_H_
