// Bayesian optimisation of a noisy or piecewise constant objective with few variables. The next
// point is the one with the largest expected improvement under a Gaussian process,
//
//   EI(x) = (f* - μ(x)) Φ(z) + σ(x) φ(z),   z = (f* - μ(x)) / σ(x),
//
// with the posterior mean μ and standard deviation σ, and the distribution function Φ and density φ
// of the standard normal distribution (D. R. Jones, M. Schonlau and W. J. Welch, "Efficient global
// optimization of expensive black-box functions", 1998, eq. 15). Because the values are noisy, f*
// is the least posterior mean at the evaluated points instead of the least value. Each evaluation
// requires a fit to all earlier points, which costs O(N³) per likelihood, about 10 ms at N = 100.
// This is negligible for an objective that takes seconds.
#ifndef LACUNA_SEARCH_GAUSSIAN_PROCESS_SEARCH_H_
#define LACUNA_SEARCH_GAUSSIAN_PROCESS_SEARCH_H_

#include <cstdint>

#include "search/search_problem.h"

namespace lacuna {

struct GaussianProcessSearchOptions {
  // Points spread over the box before the first fit, including the start; 0 means n + 2.
  int initial_points = 0;
  // Number of points per evaluation at which the expected improvement is computed; half of them lie
  // near the best point. Raising it finds the maximum more reliably.
  int candidates = 600;
  // Limit on the evaluations of the likelihood per fit of the scales. Raising it makes the fit more
  // accurate and slower.
  int likelihoods = 60;
  uint64_t seed = 1;  // seed of the random candidates
};

// Minimises a bounded problem without constraints and with at most ten free variables (CHECK). The
// search has no convergence test; it ends when a limit of `control` is reached, or after as many
// proposals as twice control.max_evaluations if some of these repeat known points. A failed
// evaluation enters the regression with the upper quartile of the successful values. Throws
// InputError if the log cannot be used (evaluation_log.h), and any exception of the objective.
SearchResult MinimiseByGaussianProcess(const SearchProblem& problem, const SearchControl& control,
                                       const GaussianProcessSearchOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_GAUSSIAN_PROCESS_SEARCH_H_
