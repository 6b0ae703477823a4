// The COBYLA and BOBYQA of the library NLopt behind the seam of this module, as references.
//
// Bounds, budget, log and the rule of the best point are ours, and no point is evaluated twice. The
// library knows no failure: it is given a value that exceeds the worst one so far by the range of
// all, or 1 if there is none. A search that asks 1000 times in a row for points that are known is
// ended; one that loops without asking for any, as NLopt's COBYLA is reported to do without a
// tolerance, cannot be: give it a final radius well above rounding.
#ifndef LACUNA_SEARCH_NLOPT_SEARCH_H_
#define LACUNA_SEARCH_NLOPT_SEARCH_H_

#include "search/search_problem.h"

namespace lacuna {

enum class NloptAlgorithm {
  kCobyla,  // its variant of Powell 1994; constraints as they come
  kBobyqa,  // Powell 2009, quadratic models; problems without constraints, two free variables at
            // least
};

struct NloptOptions {
  NloptAlgorithm algorithm = NloptAlgorithm::kCobyla;
  double initial_radius = 0.25;  // as in cobyla.h
  double final_radius = 1e-3;
};

SearchResult MinimiseByNlopt(const SearchProblem& problem, const SearchControl& control,
                             const NloptOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_NLOPT_SEARCH_H_
