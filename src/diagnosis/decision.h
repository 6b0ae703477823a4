// The decision: what the recordings say is missing, from the evidence of all hypotheses.
//
// 1. The posterior over {nothing, each effect, each nuisance} follows from the Bayes factors
//    (decision_rules.h): of a refit where there is one, else to first order.
// 2. Combinations are added (combinations.h): pairs of effects, fitted or to first order, and
//    effects with a nuisance beside them, to first order.
// 3. The hypotheses that reach kStatedProbability are tested against their own residuals, the most
//    probable one first, until one leaves no more than noise (adequacy.h). If each of them leaves
//    more, something unknown is left.
// 4. The effects that they have in common are stated, else their set.
//
// Pure: the result depends on the input alone.
#ifndef LACUNA_DIAGNOSIS_DECISION_H_
#define LACUNA_DIAGNOSIS_DECISION_H_

#include "diagnosis/adequacy.h"
#include "diagnosis/decision_input.h"
#include "record/decision_record.h"
#include "record/verdict.h"

namespace lacuna {

struct Decision {
  Verdict verdict = Verdict::kNoPower;
  // The effects and nuisances of the verdict, the most probable one first. For "not in library" it
  // is the effect that explains most of the residual, if its probability allows a name.
  std::vector<std::string> names;
  DecisionRecord record;  // without power and separations (recording_power.h)
};

Decision Decide(const DecisionInput& input);

// DecisionRecord::probabilities of Decide() alone, the most probable hypothesis first. The tests
// and the simulations, which take most of the time of Decide(), are left out.
std::vector<HypothesisProbability> PosteriorOf(const DecisionInput& input);

// The family of an effect; kOther where it has none.
EffectFamily FamilyOf(const std::map<std::string, EffectFamily>& families,
                      const std::string& effect);

// The hypotheses of a space with their evidence, and "nothing", without probabilities.
std::vector<HypothesisProbability> HypothesesOf(const std::vector<NamedEvidence>& evidence,
                                                const std::map<std::string, EffectFamily>& families,
                                                double model_error);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_DECISION_H_
