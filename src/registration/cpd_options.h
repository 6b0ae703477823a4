// The settings of non-rigid Coherent Point Drift.
#ifndef LACUNA_REGISTRATION_CPD_OPTIONS_H_
#define LACUNA_REGISTRATION_CPD_OPTIONS_H_

#include "registration/gaussian_sums.h"

namespace lacuna {

// The unit "size" below is the rms distance of the source points from their mean.
struct CpdOptions {
  // The range of the outlier weight. At 0 or 1 its estimate could not recover, and at 0 a point far
  // from all others would have no weight at all.
  static constexpr double kFewestOutliers = 1e-3;
  static constexpr double kMostOutliers = 0.8;

  // Width β > 0 of the kernel, in sizes. Raising it makes the motion stiffer, needs fewer basis
  // functions, and lets missing parts follow from a greater distance.
  double beta = 1.5;
  // Width (> 0, in sizes) and variance (≥ 0, relative to the first) of a second Gaussian in the
  // kernel, for local dents. Raising the variance allows more local detail and more fitting of
  // noise; 0 leaves only the first Gaussian.
  double fine_beta = 0.4;
  double fine_variance = 0.02;
  // Weight λ > 0 of motion coherence per target point. Raising it makes motions smaller and
  // smoother.
  double lambda = 0.01;
  // Weight ≥ 0 of the strain energy per target point. Raising it reduces stretch and shear of the
  // surface; 0 is plain CPD.
  double rigidity = 5.0;
  // Weight of distances within the surface relative to those along its normal, 0 < … ≤ 1. Raise it
  // if source and target contain the same points (tracked markers); 1 is plain CPD.
  double tangential_weight = 0.003;
  // Start with the source shifted to the mean of the target and scaled to its size, which requires
  // that both show the whole body. Otherwise start without displacement. A warm start takes
  // precedence.
  bool match_extents = false;
  // Probability that a target point belongs to no source point, kFewestOutliers … kMostOutliers:
  // the initial value if it is estimated (the estimate stays in this range), else the value
  // throughout.
  double outlier_weight = 0.1;
  bool estimate_outlier_weight = true;
  // Initial σ, m; 0 derives it from the distances between the clouds. Raise it for larger motions.
  double initial_sigma = 0.0;
  // Lower bound of σ, > 0, in spacings of the sparser cloud. Raising it gives a smoother result
  // that misses small features.
  double sigma_floor = 0.7;
  // Distance > 0 at which the Gaussians are truncated, in σ. Raising it is slower and closer to the
  // untruncated sums.
  double cutoff = 3.5;
  // The number of basis functions is at most `max_rank` (≥ 4), at most one per
  // `points_per_function` source points, and no more than needed to explain all but the fraction
  // `rank_tolerance` (0 < … ≤ 1) of the kernel's variance. More functions resolve finer motions and
  // take longer.
  int max_rank = 64;
  int points_per_function = 40;
  double rank_tolerance = 1e-4;
  // Converged if an iteration moves the points by less than this (rms), in units of sigma_floor
  // times the spacing of the source. Raising it saves iterations.
  double tolerance = 0.0057;
  int max_iterations = 60;  // upper limit for each level, ≥ 1
  // The implementation of the inner loops; by default the fastest that this processor supports.
  const GaussianKernels* kernels = &BestKernels();
};

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_CPD_OPTIONS_H_
