// COBYLA and BOBYQA of the library NLopt with this module's interface, for comparison with our own
// searches.
//
// Bounds, stopping rules, log and the choice of the best point are those of the other searches, and
// no point is evaluated twice. NLopt has no failed evaluations, so a failed evaluation returns a
// value that exceeds the largest value so far by at least the range of the values, or 1 if there is
// no value yet. A search that requests more than 1000 known points in succession is stopped. A
// search that loops without requesting any point, as has been reported of NLopt's COBYLA without a
// tolerance, cannot be stopped; the final radius should therefore be well above rounding errors.
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
  // Initial and final radius as in CobylaOptions (cobyla.h), in the units of the variables.
  double initial_radius = 0.25;
  double final_radius = 1e-3;
};

// Minimises the objective. An exception of the objective or of the log (InputError) is rethrown
// after NLopt has returned. If NLopt reports a failure, the status is kLibrary with NLopt's
// message.
SearchResult MinimiseByNlopt(const SearchProblem& problem, const SearchControl& control,
                             const NloptOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_NLOPT_SEARCH_H_
