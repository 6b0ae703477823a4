// Many amplitudes at once from a residual, with a prior whose width the data chooses.
//
// With the whitened residual r of a fitted model, what its fit can still do taken away
// (fitted_model.h), and its derivative S by amplitudes a of one kind and unit,
//   r + S a ~ N(0, v C),   a ~ N(0, s² L Lᵀ),   v ≥ 1,
// the width s and, of several given, the shape L are taken from the marginal likelihood (type II
// maximum likelihood: MacKay, Neural Computation 4, 1992), with v what they leave: a residual that
// no amplitude explains counts as noise. Of all s nearly as likely as the best one the largest is
// used, so that amplitudes which the data hardly sees keep an honest deviation instead of being
// declared zero.
#ifndef LACUNA_ANALYSIS_AMPLITUDE_ESTIMATE_H_
#define LACUNA_ANALYSIS_AMPLITUDE_ESTIMATE_H_

#include <Eigen/Core>
#include <vector>

#include "analysis/fitted_model.h"

namespace lacuna {

struct AmplitudeEstimate {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
  double width = 0;     // s, of the prior
  int shape = 0;        // which L
  double noise = 1;     // √v: by how much what stays unexplained exceeds the noise
  double evidence = 0;  // ln of the likelihood with the best s over that with none
};

// `by`: n × k, ∂r/∂a. `coordinates`: rows that were measured (others are 0 in all of them).
// `plausible`: the largest s; the smallest that is tried is 1e-5 √v times it. `shapes`: k × k each,
// at least one.
AmplitudeEstimate EstimateAmplitudes(const FittedModel& fitted, const Eigen::MatrixXd& by,
                                     int coordinates, double plausible,
                                     const std::vector<Eigen::MatrixXd>& shapes);

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_AMPLITUDE_ESTIMATE_H_
