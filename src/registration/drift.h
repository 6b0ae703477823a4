// Expectation maximisation on one level of the coarse-to-fine hierarchy.
#ifndef LACUNA_REGISTRATION_DRIFT_H_
#define LACUNA_REGISTRATION_DRIFT_H_

#include <Eigen/Core>

#include "registration/cpd_options.h"
#include "registration/gaussian_basis.h"
#include "registration/posterior.h"
#include "registration/registration_level.h"

namespace lacuna {

// The state that is passed from level to level. Lengths are in the frame of NormalisedClouds.
struct Drift {
  Eigen::Matrix3Xd coefficients;  // 3 × K
  double sigma = 0.0;
  double outlier_weight = 0.0;
  int iterations = 0;       // total over all levels so far
  bool converged = false;   // whether the latest level converged
  bool has_overlap = true;  // false if almost no target point belongs to the source

  // Results of the last level.
  Posterior posterior;
  Eigen::Matrix3Xf displacement;  // 3 × M
  Eigen::MatrixXd covariance;     // K × K, covariance of the coefficients, summed over the axes
  double prior_scale = 1.0;  // s², the estimated variance of the prior relative to the options'
};

struct Level {
  int source_stride = 1;  // every how many points of the source are used
  int target_stride = 1;  // every how many points of the target are used
  double floor = 0.0;     // lower bound of σ
  bool is_last = true;
};

// Iterates until convergence or options.max_iterations; returns early without overlap. `basis` may
// be the leading part of the basis of drift->coefficients. Reduces drift->sigma, but not below the
// level's floor.
void RunLevel(const NormalisedClouds& clouds, const Level& level, const GaussianBasis& basis,
              const CpdOptions& options, Drift* drift);

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_DRIFT_H_
