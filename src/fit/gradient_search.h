// A search along the gradient, by Ceres' BFGS, behind the seam of search/search_problem.h.
//
// Ceres' line-search methods know no bounds: the search runs over angles t with
//   x = lower + (upper − lower) (1 − cos t) / 2,
// so that no x lies outside of them. At a bound itself x no longer answers to t; a start nearer to
// one than a thousandth of the range is moved there.
//
// Derivatives that the problem does not give are central differences, one-sided at a bound or where
// a side fails; their evaluations count as all others. Where neither side succeeds the point is
// taken for a failure.
#ifndef LACUNA_FIT_GRADIENT_SEARCH_H_
#define LACUNA_FIT_GRADIENT_SEARCH_H_

#include "search/search_problem.h"

namespace lacuna {

struct GradientSearchOptions {
  double initial_radius = 0.25;  // length of the first step in mid-range, as in search/cobyla.h
  double final_radius = 1e-3;    // ends when steps become shorter than this part of t
  // Of the differences, in parts of the range; larger: less noise, more curvature in them.
  double difference = 0.1;
};

// For bounded problems without constraints. The message tells how many gradients were taken, and
// how many derivatives in them were differences.
SearchResult MinimiseByGradient(const SearchProblem& problem, const SearchControl& control,
                                const GradientSearchOptions& options);

}  // namespace lacuna

#endif  // LACUNA_FIT_GRADIENT_SEARCH_H_
