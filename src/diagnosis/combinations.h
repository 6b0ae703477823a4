// Hypotheses of two causes: two effects, one effect twice (at two places, or with two relaxation
// times), or an effect and a nuisance beside it.
//
// Let A be an effect, R(A) its evidence, and e(B | A) that of a further hypothesis B beside the
// refit with A. The evidence of both is
//   R(A) + e(B | A) − ½ u² − ½ · 1 % · 2 R(A) + ln p,
// where ½ u² is the unknown model error of the space (hypothesis_space.h), and the next term is
// what the error of A's model adds to it: a later diagnosis of the model with A would subtract the
// same. p = 2 for two different effects, either of which may be found first, and 1 for one effect
// twice; for a nuisance it is the prior probability that there is one. Combinations that gain nothing are left out, unless they were
// fitted.
//
// e(B | A) is that of a fit of both, if there is one, else of first order; an effect with a
// nuisance is never fitted. All functions are pure.
#ifndef LACUNA_DIAGNOSIS_COMBINATIONS_H_
#define LACUNA_DIAGNOSIS_COMBINATIONS_H_

#include <string>
#include <vector>

#include "diagnosis/adequacy.h"
#include "diagnosis/decision_input.h"
#include "record/decision_record.h"

namespace lacuna {

// The refit with this effect beside the adopted nuisances; null: there is none.
const WeighedRefit* FindRefit(const DecisionInput& input, const std::string& effect);

// Whether the model could not be fitted with these two effects.
bool HasFailed(const DecisionInput& input, const std::string& a, const std::string& b);

// What the adopted nuisances add to the evidence of every hypothesis beside which they stand: their
// own evidence, and the prior probability that there is such a nuisance. 0 where there are none.
double EvidenceOfAdopted(const DecisionInput& input);

// The space in which a hypothesis is tested, and its columns there beside the base.
struct TestedSpace {
  const HypothesisSpace* space;
  std::vector<int> columns;
};
// `first_order`: the evidence of all hypotheses beside the baseline. Must not outlive `input`.
TestedSpace TestedSpaceOf(const DecisionInput& input, const std::vector<NamedEvidence>& first_order,
                          const HypothesisProbability& hypothesis);

// An effect together with a further effect or a nuisance, and the space in which both are tested.
struct Combination {
  HypothesisProbability hypothesis;
  TestedSpace tested;
};

// The pairs of effects that were fitted, and each effect that was refitted, or the most probable
// one, with the best further effect and with each nuisance beside it. `posterior`: of single
// hypotheses, sorted. Must not outlive `input`.
std::vector<Combination> CombinationsOf(const DecisionInput& input,
                                        const std::vector<NamedEvidence>& first_order,
                                        const std::vector<HypothesisProbability>& posterior);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_COMBINATIONS_H_
