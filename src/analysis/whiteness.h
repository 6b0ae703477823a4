// Whether the residuals of a prediction are noise: unrelated in time and in space. Matrices as in
// residual_statistics.h.
#ifndef LACUNA_ANALYSIS_WHITENESS_H_
#define LACUNA_ANALYSIS_WHITENESS_H_

#include <Eigen/Core>
#include <vector>

#include "analysis/residual_statistics.h"

namespace lacuna {

// P(X > statistic) for χ² with that many degrees of freedom (≥ 1), by the finite sum for whole
// degrees (Abramowitz & Stegun 1964, 26.4.4 and 26.4.5).
double ChiSquareTail(double statistic, int degrees_of_freedom);

// Whether the rows of `series` (any number, equally spaced columns) are white in time. Each row's
// mean, of the entries seen, is taken away first.
//   ρ_k = Σ e_f e_{f+k} / Σ e_f²
//   Q   = Σ_rows n (n + 2) Σ_{k=1..h} ρ_k² / n_k
// (Ljung & Box, Biometrika 65, 1978; n_k, the pairs of frames both seen, is n − k without gaps, as
// Stoffer & Toloi, Stat. Prob. Lett. 13, 1992). h is ten, or a fifth of the frames where these are
// fewer than fifty. The p-value is not χ²'s, which would need rows that know nothing of each other
// and is too small in the far tail: it is the share of random orders of the frames, all rows
// alike, whose Q is as large (a permutation test; Good, Springer 2005), exact where the frames are
// exchangeable however the rows depend on one another. The orders are the same in each call.
struct TimeWhiteness {
  int lags = 0;                 // h; 0: too few frames (< 10 in every row), nothing below is known
  double statistic = kUnknown;  // Q
  double lag_one = kUnknown;    // ρ_1, rows pooled
  // The lag, in frames, where the pooled ρ has fallen to 1/e, between lags linearly; about 0.6 for
  // white noise, infinite where it does not fall so far within half of the frames.
  double correlation_frames = kUnknown;
  double p_value = kUnknown;  // never below 1/(orders + 1); 999 orders, of long series 199
};
TimeWhiteness WhitenessInTime(const Eigen::MatrixXd& series);

// Whether different points' vectors are related, against their distance. The vectors' means over
// time are taken away first.
struct PointPair {
  int first = 0, second = 0;
  double distance = 0;            // m, between `places`
  double correlation = kUnknown;  // Σ_f e_i · e_j / √(Σ_f |e_i|² Σ_f |e_j|²), frames that saw both
};
struct SpaceWhiteness {
  std::vector<PointPair> pairs;
  double mean_correlation = kUnknown;
  // ℓ of exp(−d/ℓ), least squares over the pairs, m: 0 where it would be below a tenth of the
  // smallest distance, infinite where above ten times the largest.
  double correlation_length = kUnknown;
  // Of Σ n' ρ² over pairs and axes, χ² if unrelated (Breusch & Pagan, Rev. Econ. Stud. 47, 1980),
  // with n' = n (1 − ρ_1i ρ_1j) / (1 + ρ_1i ρ_1j) independent frames of two rows that are
  // correlated in time themselves (Bartlett, J. R. Stat. Soc. 98, 1935).
  double p_value = kUnknown;
};
SpaceWhiteness WhitenessInSpace(const Eigen::MatrixXd& vectors, const Eigen::Matrix3Xd& places);

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_WHITENESS_H_
