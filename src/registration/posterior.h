// The E-step of Coherent Point Drift: the probabilities that target points belong to source points.
#ifndef LACUNA_REGISTRATION_POSTERIOR_H_
#define LACUNA_REGISTRATION_POSTERIOR_H_

#include <Eigen/Core>

#include "registration/block_tree.h"
#include "registration/gaussian_sums.h"

namespace lacuna {

// The mixture of Myronenko & Song 2010, Eq. 1. A target point is an outlier with probability ω,
// uniformly distributed over a volume V; otherwise it comes from one of the M source points with
// equal probability, with isotropic Gaussian noise of standard deviation σ. (The paper uses 1/N for
// the outlier density, which has no unit; with V the meaning of ω does not depend on the size of
// the object.)
struct Mixture {
  double sigma = 0.0;           // σ, in the length unit of the trees
  double outlier_weight = 0.0;  // ω in [0, 1)
  double outlier_volume = 1.0;  // V
  double cutoff = 4.0;          // the Gaussians are truncated at cutoff·σ
};

// Sums over p_mn, the probability that target point n comes from source point m (Eq. 6). Lengths
// are in the unit of the trees.
struct Posterior {
  Eigen::VectorXf weight;     // M: P_m = Σ_n p_mn
  Eigen::Matrix3Xf shift;     // 3 × M: Σ_n p_mn (x_n − t_m) / P_m; 0 if P_m = 0
  Eigen::VectorXf inlier;     // N: Σ_m p_mn, the probability that target point n is not an outlier
  double total_weight = 0.0;  // Σ_m P_m, the expected number of inliers
  double total_spread = 0.0;  // Σ_mn p_mn |x_n − t_m|²
};

// Computes the sums in two passes: the first stores the weight 1 / Σ_m … of each target point in
// `target`, the second uses them. Both truncate the same pairs, so that Σ_m p_mn ≤ 1 holds for the
// truncated sums, too.
Posterior ComputePosterior(const BlockTree& source, const Mixture& mixture,
                           const GaussianKernels& kernels, BlockTree* target);

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_POSTERIOR_H_
