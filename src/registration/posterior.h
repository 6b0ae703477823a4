// The E-step of Coherent Point Drift: which target points does each source point explain?
#ifndef LACUNA_REGISTRATION_POSTERIOR_H_
#define LACUNA_REGISTRATION_POSTERIOR_H_

#include <Eigen/Core>

#include "registration/block_tree.h"
#include "registration/gaussian_sums.h"

namespace lacuna {

// The mixture of Myronenko & Song 2010, Eq. 1, in which a target point is either an outlier, with
// probability ω and spread evenly over a volume V, or comes from one of the M source points, each
// as likely as the other, with an isotropic Gaussian of standard deviation σ. (The paper spreads
// outliers as 1/N, which has no unit; V makes ω mean the same for every size of object.)
struct Mixture {
  double sigma = 0.0;
  double outlier_weight = 0.0;  // ω in [0, 1)
  double outlier_volume = 1.0;  // V
  double cutoff = 4.0;          // Gaussians end at cutoff·σ
};

// With p_mn the probability that target n comes from source m (Eq. 6), in lengths of the trees:
struct Posterior {
  Eigen::VectorXf weight;     // M: P_m = Σ_n p_mn
  Eigen::Matrix3Xf shift;     // 3 × M: Σ_n p_mn (x_n − t_m), divided by P_m; 0 where P_m = 0
  Eigen::VectorXf inlier;     // N: Σ_m p_mn, the probability that target n is no outlier
  double total_weight = 0.0;  // Σ_m P_m, the number of target points that are no outliers
  double total_spread = 0.0;  // Σ_mn p_mn |x_n − t_m|²
};

// Leaves in `target` the weights 1 / Σ_m … of its points, which the second of the two passes reads.
// Both passes cut the same pairs, so that Σ_m p_mn ≤ 1 holds for the truncated sums too.
Posterior ComputePosterior(const BlockTree& source, const Mixture& mixture,
                           const GaussianKernels& kernels, BlockTree* target);

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_POSTERIOR_H_
