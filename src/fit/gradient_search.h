// A gradient-based search with the BFGS method of Ceres, for the interface of
// search/search_problem.h.
//
// The line-search methods of Ceres do not support bounds, so the search runs over angles t with
//   x = lower + (upper − lower) (1 − cos t) / 2,
// which keeps x within its bounds. Since dx/dt vanishes on a bound, a start closer to a bound than
// a thousandth of the range is moved to this distance.
//
// Derivatives that the problem does not provide are central differences, or one-sided differences
// at a bound and where one side cannot be evaluated. Their evaluations are counted like all others.
// If neither side can be evaluated, the evaluation of the point counts as failed.
#ifndef LACUNA_FIT_GRADIENT_SEARCH_H_
#define LACUNA_FIT_GRADIENT_SEARCH_H_

#include "search/search_problem.h"

namespace lacuna {

struct GradientSearchOptions {
  double initial_radius = 0.25;  // length of the first step in mid-range, as in search/cobyla.h
  double final_radius = 1e-3;    // the search ends at a step of this relative length in t
  // Half-width of the differences, as a fraction of the range. A larger value reduces the influence
  // of noise and increases the truncation error.
  double difference = 0.1;
};

// Minimises a problem with bounds and without constraints (CHECK). The message of the result states
// the numbers of gradients and of derivatives by differences. Exceptions thrown by the problem are
// passed on to the caller.
SearchResult MinimiseByGradient(const SearchProblem& problem, const SearchControl& control,
                                const GradientSearchOptions& options);

}  // namespace lacuna

#endif  // LACUNA_FIT_GRADIENT_SEARCH_H_
