// Normally distributed amounts that must be positive: x ~ N(m, C), restricted to x ≥ 0.
//
// Two amounts are treated exactly. In units of their deviations, with the means a and b, the
// correlation ρ and the standard normal density φ and distribution Φ,
//   P(x > 0) = ∫₀^∞ φ(u − a) Φ((b + ρ (u − a)) / √(1 − ρ²)) du,
// where the integrand divided by P(x > 0) is the density of the first amount under the restriction.
#ifndef LACUNA_ANALYSIS_POSITIVE_NORMAL_H_
#define LACUNA_ANALYSIS_POSITIVE_NORMAL_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace lacuna {

// ln(2ⁿ P(x > 0)): the factor by which priors that are truncated at 0 change the evidence of n
// amounts, which are independent in the prior and have the posterior N(m, C). For one amount it is
// LogTwiceNormal(); for two its error is below 1e-12 (in the tails below 1e-12 of it). Of more, one
// after another is conditioned on being positive, with the others taken to stay normal with the
// moments that this leaves them, until two are left (Mendell & Elston, Biometrics 30, 1974): an
// approximation. C must be regular.
double LogOrthantFactor(Eigen::VectorXd mean, Eigen::MatrixXd covariance);

// A draw from N(m, C) given that all x are positive, which depends on the arguments alone. Exact
// for one and two amounts; for more by Gibbs sampling of two after another. C must be regular.
Eigen::VectorXd DrawPositive(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance,
                             uint64_t bits);

// Where N(m, C) has its largest density if the amounts of the indices `positive` must not be
// negative. C must be regular.
Eigen::VectorXd PositiveMode(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance,
                             const std::vector<Eigen::Index>& positive);

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_POSITIVE_NORMAL_H_
