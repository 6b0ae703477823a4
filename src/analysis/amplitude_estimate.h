// Joint estimation of many amplitudes from a residual, under a prior with a width estimated from
// the data.
//
// Let r be the whitened residual of a fitted model, C its covariance when the fit is taken into
// account (fitted_model.h), and S = ∂r/∂a its Jacobian with respect to amplitudes a of one kind and
// unit. The model is
//   r + S a ~ N(0, v C),   a ~ N(0, s² L Lᵀ),   v ≥ 1.
// The width s and the shape L, one of several candidates, maximise the marginal likelihood (type II
// maximum likelihood: MacKay, Neural Computation 4, 1992). The noise factor v follows from the
// residual that remains, so that a residual which no amplitude explains counts as noise. Among the
// widths that are nearly as likely as the best one, the largest is used: amplitudes to which the
// data are hardly sensitive then keep a realistic deviation instead of being estimated as zero.
#ifndef LACUNA_ANALYSIS_AMPLITUDE_ESTIMATE_H_
#define LACUNA_ANALYSIS_AMPLITUDE_ESTIMATE_H_

#include <Eigen/Core>
#include <vector>

#include "analysis/fitted_model.h"

namespace lacuna {

struct AmplitudeEstimate {
  Eigen::VectorXd mean;        // k, posterior mean in the unit of the amplitudes
  Eigen::MatrixXd covariance;  // k × k, posterior covariance
  double width = 0;            // s, in the unit of the amplitudes
  int shape = 0;               // index of the chosen L
  double noise = 1;     // √v: standard deviation of the remaining residual over that of the noise
  double evidence = 0;  // natural log of the likelihood ratio of the best s to s = 0
};

// `jacobian` is S (n × k), and `coordinates` the number of rows that were measured (> 0; all other
// rows are 0). `plausible` (> 0) is the largest s; the smallest one tried is 1e-5 √v times as
// large. `shapes` holds at least one L (k × k). Violations are programming errors (CHECK).
AmplitudeEstimate EstimateAmplitudes(const FittedModel& fitted, const Eigen::MatrixXd& jacobian,
                                     int coordinates, double plausible,
                                     const std::vector<Eigen::MatrixXd>& shapes);

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_AMPLITUDE_ESTIMATE_H_
