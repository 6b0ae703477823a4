// A search for few variables and a noisy or stepped objective: expected improvement on a Gaussian
// process.
//
// D. R. Jones, M. Schonlau and W. J. Welch, "Efficient global optimization of expensive black-box
// functions", 1998, eq. 15; under noise the improvement is counted from the least posterior mean at
// the points evaluated so far. Each evaluation costs a fit to all points before: O(N³) per
// likelihood, about 10 ms at N = 100, which an objective of seconds does not notice.
#ifndef LACUNA_SEARCH_GAUSSIAN_PROCESS_SEARCH_H_
#define LACUNA_SEARCH_GAUSSIAN_PROCESS_SEARCH_H_

#include <cstdint>

#include "search/search_problem.h"

namespace lacuna {

struct GaussianProcessSearchOptions {
  // Points spread over the box before the first fit, the start among them; 0: n + 2.
  int initial_points = 0;
  int candidates = 600;  // tried per evaluation, half of them near the best; more: a surer maximum
  int likelihoods = 60;  // evaluated per fit of the length scales
  uint64_t seed = 1;     // of the candidates
};

// For bounded problems without constraints, of up to ten free variables. Spends the whole budget of
// `control`. A failed evaluation is taken for a value at the upper quartile of those that
// succeeded.
SearchResult MinimiseByGaussianProcess(const SearchProblem& problem, const SearchControl& control,
                                       const GaussianProcessSearchOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_GAUSSIAN_PROCESS_SEARCH_H_
