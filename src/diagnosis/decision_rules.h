// The rules of the decision: prior probabilities, the posterior over hypotheses, and when a name is
// stated. The same rules serve recorded and simulated residuals.
//
// The posterior probability of a hypothesis is its prior probability times its Bayes factor
// against the model as it is, normalised. The smallest set of hypotheses that reaches
// kStatedProbability is kept. What all of them contain is stated as missing, but for the nuisances
// that some of them have beside an effect; where they have nothing in common, the set itself is
// stated.
#ifndef LACUNA_DIAGNOSIS_DECISION_RULES_H_
#define LACUNA_DIAGNOSIS_DECISION_RULES_H_

#include <string>
#include <vector>

#include "record/decision_record.h"

namespace lacuna {

// Prior probabilities: that nothing is missing, and those that all effects, all nuisances and all
// pairs of effects share. Evidence of some tens of units makes their choice unimportant; a larger
// value for "nothing" asks for more evidence before an effect is named.
inline constexpr double kPriorNothing = 0.5, kPriorEffects = 0.3, kPriorNuisances = 0.15,
                        kPriorPairs = 0.05;
// The level of the test of adequacy: so often a complete model is said to leave something unknown.
// Lower: something unknown that is small passes for noise more often.
inline constexpr double kAdequacyLevel = 0.05;
// No model is exact. What an effect leaves is no reason to withhold its name if it is less than
// this share of the misfit that the effect removes: a model error of a tenth of the amplitude.
// Higher: effects that compensate for one outside the catalogue are named more often.
inline constexpr double kToleratedModelError = 0.01;

// Sets the probabilities from the evidence and the kind of each hypothesis, and sorts by them.
// Refuted hypotheses get the probability 0. Evidence of an effect or nuisance contains its share of
// the prior among its rivals already (NamedEvidence); that of a pair likewise. An effect with a
// nuisance beside it is of the kind "effect", and its evidence contains the prior of the nuisance.
void SetPosterior(std::vector<HypothesisProbability>* hypotheses);

// Whether two hypotheses are of one kind and have the same names. There may be several of that
// sort, because nuisances of one name exist once for each recording or grip.
bool IsRepeated(const HypothesisProbability& a, const HypothesisProbability& b);

// Merges the repeated hypotheses of a sorted posterior: adds their probabilities and their Bayes
// factors, and leaves every name in them once, but for an effect that is a pair with itself.
void MergeRepeated(std::vector<HypothesisProbability>* posterior);

// Whether `name` is a nuisance of one of the hypotheses.
bool IsNuisance(const std::vector<HypothesisProbability>& posterior, const std::string& name);

// What a posterior allows to be said.
struct Naming {
  enum class Level {
    kNothing,  // "nothing is missing" is among the hypotheses that must be kept
    kCommon,   // all hypotheses that are kept contain these effects, or all are these nuisances
    kFamily,   // several effects of one family, of which one is missing
    kSet,      // several hypotheses of different families
  };
  Level level = Level::kNothing;
  // The smallest set that reaches kStatedProbability: indices of the posterior, in its order.
  std::vector<size_t> kept;
  // The effects and nuisances that are named: at the level kCommon those that the kept hypotheses
  // have in common, otherwise all that they contain but for nuisances beside an effect.
  std::vector<std::string> names;
};
Naming NameFrom(const std::vector<HypothesisProbability>& posterior);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_DECISION_RULES_H_
