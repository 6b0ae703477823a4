// Do several recordings agree about the parameters that they share?
//
// The residual r_i of recording i, whitened, depends linearly on the change θ_i of the parameters,
// on amounts η_i of the recording's own (its hold, its clock) and on amounts μ of errors that all
// recordings share (the mesh, the shape, the places of the markers):
//   r_i + J_i θ_i + N_i η_i + S_i μ ~ N(0, v I),   η_i and μ with Gaussian priors.
// Each recording has its own θ_i, without a prior. Their joint estimate has the mean θ̂ and the
// covariance C; the estimates of two recordings are correlated only through μ. If the recordings
// agree, θ_1 = … = θ_R, and
//   χ² = Dᵀ Cov(D)⁻¹ D,   D = (θ_1 − θ_R, …, θ_{R−1} − θ_R),
// has the χ² distribution. If only the differences of the components S of D may be other than 0,
//   χ²_S = s_Sᵀ (M_SS)⁻¹ s_S,   M = Cov(D)⁻¹,   s = M D
// is the score test (Rao 1948), here the likelihood ratio test, with |S| degrees of freedom.
//
// Besides, the residual of all recordings together may contain an error e of the model, of at most
// the length u (in √v) and in any direction. It changes √χ² by at most u, so that
//   (max(0, √χ² − u))²
// is what is left for chance and for parameters that differ.
#ifndef LACUNA_ANALYSIS_AGREEMENT_H_
#define LACUNA_ANALYSIS_AGREEMENT_H_

#include <Eigen/Core>
#include <vector>

#include "analysis/linear_evidence.h"

namespace lacuna {

// One recording, along the motion at the joint estimate. Rows are whitened.
struct RecordingRows {
  Eigen::VectorXd residual;    // r
  Eigen::MatrixXd parameters;  // J: rows × p, the same p in every recording
  Eigen::MatrixXd own;         // N
  std::vector<LinearPrior> own_priors;
  Eigen::MatrixXd shared;  // S: rows × k, the same k in every recording
};

struct AgreementTest {
  // p × recordings: the estimate of each recording, as the change from the joint one, and its
  // standard deviation, which is infinite where the recording does not determine the parameter.
  Eigen::MatrixXd change, deviation;
  double chi_square = 0;       // beyond the error of the model
  int degrees_of_freedom = 0;  // the differences that the recordings determine
  double p_value = 1;          // 1 without degrees of freedom
  Eigen::VectorXd p_values;    // p: of each parameter, if it is the only one that differs
  // p × recordings: the χ² with one degree of freedom of a parameter that only this recording has
  // otherwise.
  Eigen::MatrixXd odd;
};

// `typical` (p): a change of each parameter that would matter to the user. Differences that are not
// known better than that are left out. `variance`: v. `model_error`: u. CHECKs that there are two
// recordings or more, and the sizes.
AgreementTest TestAgreement(const std::vector<RecordingRows>& recordings,
                            const std::vector<LinearPrior>& shared_priors,
                            const Eigen::VectorXd& typical, double variance,
                            double model_error = 0);

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_AGREEMENT_H_
