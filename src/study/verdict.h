// What a diagnosis allows to say.
#ifndef LACUNA_STUDY_VERDICT_H_
#define LACUNA_STUDY_VERDICT_H_

#include "study/diagnosis.h"

namespace lacuna {

// Fills verdict, effects, explanation and experiment from everything else.
void Decide(Diagnosis* diagnosis);

}  // namespace lacuna

#endif  // LACUNA_STUDY_VERDICT_H_
