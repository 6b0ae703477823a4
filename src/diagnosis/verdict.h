// What a diagnosis allows to say.
#ifndef LACUNA_DIAGNOSIS_VERDICT_H_
#define LACUNA_DIAGNOSIS_VERDICT_H_

#include "diagnosis/diagnosis_result.h"

namespace lacuna {

// What is missing, once added, leaves nothing for another effect: the right one of eight bars left
// evidence of 0.2 at most, and in one that was off by 6 σ 0.6 % of its own. One that leaves more
// than this part of its own, and than chance, does another's work or only a part of it.
inline constexpr double kLeavesMore = 0.05;

// Logarithm of the odds to be named at all.
inline constexpr double kNamed = 5;
// The evidence that the unknown part of what mesh and step change may lend an effect: more than
// twice what lies along it, as it may tilt two rivals.
double MayLend(double doubt);

// Fills verdict, effects, explanation and experiment from everything else.
void Decide(Diagnosis* diagnosis);

// Of a verdict nuisance, with Diagnosis::instead: effects that do nearly as well in place of the
// nuisances, and predict better than the model with neither, make it ambiguous.
void DecideAgainstNuisances(Diagnosis* diagnosis);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_VERDICT_H_
