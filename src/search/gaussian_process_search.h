// Bayesian optimisation of few variables with a noisy or stepped objective: expected improvement on
// a Gaussian process.
//
// D. R. Jones, M. Schonlau and W. J. Welch, "Efficient global optimization of expensive black-box
// functions", 1998, eq. 15. Because of the noise, the improvement is measured from the least
// posterior mean at the evaluated points. Each evaluation requires a fit to all earlier points,
// O(N³) per likelihood or about 10 ms at N = 100, which is negligible for an objective that takes
// seconds.
#ifndef LACUNA_SEARCH_GAUSSIAN_PROCESS_SEARCH_H_
#define LACUNA_SEARCH_GAUSSIAN_PROCESS_SEARCH_H_

#include <cstdint>

#include "search/search_problem.h"

namespace lacuna {

struct GaussianProcessSearchOptions {
  // Points spread over the box before the first fit, including the start; 0 means n + 2.
  int initial_points = 0;
  // Points per evaluation at which the expected improvement is computed, half of them near the best
  // one. Raising it finds its maximum more reliably.
  int candidates = 600;
  int likelihoods = 60;  // evaluations of the likelihood per fit of the length scales
  uint64_t seed = 1;     // seed of the random candidates
};

// Minimises a bounded problem without constraints and with at most ten free variables (CHECK).
// Always uses the whole budget of `control`. A failed evaluation enters the regression with the
// upper quartile of the successful values.
SearchResult MinimiseByGaussianProcess(const SearchProblem& problem, const SearchControl& control,
                                       const GaussianProcessSearchOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_GAUSSIAN_PROCESS_SEARCH_H_
