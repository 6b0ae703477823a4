// The effects, and the pairs of effects, that a diagnosis has left and that a plan weighs.
#ifndef LACUNA_PLAN_RIVALS_H_
#define LACUNA_PLAN_RIVALS_H_

#include <string>
#include <vector>

#include "record/diagnosis_record.h"
#include "record/plan_record.h"

namespace lacuna {

// Whether a hypothesis is that an effect, or a pair of effects, is missing.
bool IsOfEffects(const HypothesisProbability& one);

// The effect of such a hypothesis, or the two of a pair in alphabetical order, without the
// nuisances beside them, which stand behind. `all`: the hypotheses of the diagnosis.
std::vector<std::string> EffectsOf(const std::vector<HypothesisProbability>& all,
                                   const HypothesisProbability& one);

// PlannedRival::effect, "drag with gravity".
std::string RivalName(const std::vector<std::string>& effects);

// The effects and the pairs of effects among the hypotheses that the diagnosis must keep to reach
// kStatedProbability, the most probable one first, each with the sum over its hypotheses. Their
// PlannedRival::named_now is not set.
std::vector<PlannedRival> RivalsOf(const DiagnosisRecord& diagnosis);

}  // namespace lacuna

#endif  // LACUNA_PLAN_RIVALS_H_
