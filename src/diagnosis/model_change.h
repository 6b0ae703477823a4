// A prediction study whose model is changed as a hypothesis says: by one more effect, or by another
// elasticity law in place of its own.
#ifndef LACUNA_DIAGNOSIS_MODEL_CHANGE_H_
#define LACUNA_DIAGNOSIS_MODEL_CHANGE_H_

#include "diagnosis/candidates.h"
#include "diagnosis/scored_effect.h"
#include "prediction/prediction_study.h"

namespace lacuna {

// With a candidate's own effect, none of its parameters fitted. An elasticity law takes over the
// moduli, those that are fitted too, from the one whose place it takes.
PredictionStudy WithCandidate(const PredictionStudy& study, const CandidateEffect& candidate);

// With the effect at the size that first order expects (a pilot: at its pilot setting), all of its
// parameters fitted, within what its card calls plausible. Shares no effect with `scored`.
PredictionStudy WithEffect(const PredictionStudy& study, const ScoredVariant& scored);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_MODEL_CHANGE_H_
