// Which variants of an effect a refit may move into one another.
#ifndef LACUNA_DIAGNOSIS_REFIT_REACH_H_
#define LACUNA_DIAGNOSIS_REFIT_REACH_H_

#include <cstddef>
#include <vector>

#include "diagnosis/candidate_effect.h"

namespace lacuna {

// Whether a refit of the candidate moves this parameter of its effect (an index of the card).
bool IsMovedByRefit(const CandidateEffect& candidate, size_t parameter);

// The share of the variants of the candidate's effect among `candidates`, itself included, that a
// refit of it may end at: those that differ from it in parameters only that the refit moves. It
// does not move a setting, such as the side of a body on which a support lies.
double ReachableShare(const CandidateEffect& candidate,
                      const std::vector<CandidateEffect>& candidates);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_REFIT_REACH_H_
