// EM on one level of the clouds.
#ifndef LACUNA_REGISTRATION_DRIFT_H_
#define LACUNA_REGISTRATION_DRIFT_H_

#include <Eigen/Core>

#include "registration/coherent_point_drift.h"
#include "registration/gaussian_basis.h"
#include "registration/posterior.h"
#include "registration/registration_level.h"

namespace lacuna {

// What the levels pass on. Lengths are in the frame of NormalisedClouds.
struct Drift {
  Eigen::Matrix3Xd coefficients;  // 3 × K
  double sigma = 0.0;
  double outlier_weight = 0.0;
  double noise = 0.0;  // rms distance of target points along the normals
  int iterations = 0;
  bool converged = false;
  bool has_overlap = true;

  // Of the last level.
  Posterior posterior;
  Eigen::Matrix3Xf displacement;  // 3 × M
  Eigen::MatrixXd covariance;     // K × K, of the coefficients, summed over the axes
  double prior_scale = 1.0;       // s²: how much wider than the options' the prior was taken
};

struct Level {
  int source_stride = 1;
  int target_stride = 1;
  double floor = 0.0;  // of σ
  bool is_last = true;
};

// Iterates until the points rest or the options' limit. `basis` may be the leading part of that of
// the coefficients. Lets σ fall from drift->sigma to no less than the level's floor.
void RunLevel(const NormalisedClouds& clouds, const Level& level, const GaussianBasis& basis,
              const CpdOptions& options, Drift* drift);

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_DRIFT_H_
