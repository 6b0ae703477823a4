// The COBYLA and BOBYQA of the library NLopt behind this module's interface, as references.
//
// Bounds, budget, log and the choice of the best point are those of the other searches, and no
// point is evaluated twice. NLopt does not know failed evaluations: they get a value that exceeds
// the worst one so far by the range of all, or 1 if there is none. A search that requests known
// points 1000 times in a row is stopped. A search that loops without requesting any point, as is
// reported of NLopt's COBYLA without a tolerance, cannot be stopped, so choose a final radius well
// above rounding.
#ifndef LACUNA_SEARCH_NLOPT_SEARCH_H_
#define LACUNA_SEARCH_NLOPT_SEARCH_H_

#include "search/search_problem.h"

namespace lacuna {

enum class NloptAlgorithm {
  kCobyla,  // NLopt's variant of Powell 1994
  kBobyqa,  // Powell 2009, quadratic models; no constraints, at least two free variables (CHECK)
};

struct NloptOptions {
  NloptAlgorithm algorithm = NloptAlgorithm::kCobyla;
  double initial_radius = 0.25;  // as in cobyla.h
  double final_radius = 1e-3;
};

// Minimises the objective. An exception of the objective is thrown on after NLopt has returned.
SearchResult MinimiseByNlopt(const SearchProblem& problem, const SearchControl& control,
                             const NloptOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_NLOPT_SEARCH_H_
