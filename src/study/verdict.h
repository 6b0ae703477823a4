// What a diagnosis allows to say.
#ifndef LACUNA_STUDY_VERDICT_H_
#define LACUNA_STUDY_VERDICT_H_

#include "study/diagnosis.h"

namespace lacuna {

// Fills verdict, effects, explanation and experiment from everything else.
void Decide(Diagnosis* diagnosis);

// Of a verdict nuisance, with Diagnosis::instead: effects that do nearly as well in place of the
// nuisances, and predict better than the model with neither, make it ambiguous.
void DecideAgainstNuisances(Diagnosis* diagnosis);

}  // namespace lacuna

#endif  // LACUNA_STUDY_VERDICT_H_
