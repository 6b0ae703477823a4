// Tests of whether residuals are white, i.e. uncorrelated in time and in space. The matrices are
// laid out as in residual_statistics.h.
#ifndef LACUNA_ANALYSIS_WHITENESS_H_
#define LACUNA_ANALYSIS_WHITENESS_H_

#include <Eigen/Core>
#include <vector>

#include "analysis/residual_statistics.h"

namespace lacuna {

// The tail probability P(X > statistic) of the χ² distribution with the given number of degrees of
// freedom (≥ 1), by its finite sum (Abramowitz & Stegun 1964, 26.4.4 and 26.4.5). NaN for NaN.
double ChiSquareTail(double statistic, int degrees_of_freedom);

// Tests whether the rows of `series` (any number of rows, equally spaced columns) are white in
// time. The mean of each row is subtracted first. With the residuals e_f in frame f,
//   ρ_k = Σ e_f e_{f+k} / Σ e_f²
//   Q   = Σ_rows n (n + 2) Σ_{k=1..h} ρ_k² / n_k
// (Ljung & Box, Biometrika 65, 1978). n_k is the number of pairs of frames that were both seen, n −
// k without gaps (Stoffer & Toloi, Stat. Prob. Lett. 13, 1992), and h is 10, or a fifth of the
// frames if there are fewer than 50. The p-value is that of a permutation test (Good, Springer
// 2005): the fraction of random orders of the frames, common to all rows, with a Q at least as
// large. It is exact for exchangeable frames, however the rows depend on each other, whereas the χ²
// distribution would require independent rows and is inaccurate in the far tail. Every call uses
// the same orders.
struct TimeWhiteness {
  int lags = 0;                 // h; 0: fewer than 10 frames in every row, then all below is NaN
  double statistic = kUnknown;  // Q
  double lag_one = kUnknown;    // ρ_1, pooled over the rows
  // The lag, in frames, at which the pooled ρ has decreased to 1/e, interpolated linearly. About
  // 0.6 for white noise; infinite if ρ stays above 1/e over half of the frames.
  double correlation_frames = kUnknown;
  double p_value = kUnknown;  // at least 1/(orders + 1); 999 orders, or 199 for long series
};
TimeWhiteness WhitenessInTime(const Eigen::MatrixXd& series);

// Tests whether the errors of m different points are correlated, as a function of the distance
// between their places (3 × m, m). `vectors` has one row per component and n columns: c·m × n, the
// c components of a point in consecutive rows (3 for vectors, 1 for errors along a normal). Their
// temporal means are subtracted first.
struct PointPair {
  int first = 0, second = 0;  // columns of `places`
  double distance = 0;        // m
  double correlation = kUnknown;  // Σ_f e_i · e_j / √(Σ_f |e_i|² Σ_f |e_j|²), over common frames
};
struct SpaceWhiteness {
  std::vector<PointPair> pairs;
  double mean_correlation = kUnknown;  // mean over the pairs
  // The length ℓ (m) of the correlation exp(−d/ℓ), by least squares over the pairs. 0 if it is
  // below a tenth of the smallest distance, infinite if it is above ten times the largest.
  double correlation_length = kUnknown;
  // The p-value of Σ n ρ² over pairs and axes (Breusch & Pagan, Rev. Econ. Stud. 47, 1980) by a
  // randomisation test: the fraction of random circular shifts in time, one lag for all components
  // of a point, with a sum at least as large. The shifts leave each point's correlation in time as
  // it is (Lotwick & Silverman, J. R. Stat. Soc. B 44, 1982), so that correlation in time is not
  // taken for correlation between points. In simulations of independent points whose errors are
  // correlated over a twentieth of the frames, 2 % of the p-values were below 0.01 and 10 % below
  // 0.05; over a quarter of the frames, 13 % and 29 %. Every call uses the same shifts; of more
  // than 100 points, 100 are tested.
  double p_value = kUnknown;  // at least 1/(shifts + 1); 999 shifts, down to 199 for long series
};
SpaceWhiteness WhitenessInSpace(const Eigen::MatrixXd& vectors, const Eigen::Matrix3Xd& places);

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_WHITENESS_H_
