// The effects that a model may lack, each at its null value.
//
// The derivative of a prediction with respect to the size of an effect tells how much of the effect
// the recordings ask for, but it needs a place, a direction or a time scale. The card of the effect
// (record/effect_card.h) says which of these are enumerated; each combination is one candidate.
#ifndef LACUNA_DIAGNOSIS_CANDIDATES_H_
#define LACUNA_DIAGNOSIS_CANDIDATES_H_

#include <vector>

#include "diagnosis/candidate_effect.h"
#include "diagnosis/candidate_variants.h"

namespace lacuna {

// All effects of the catalogue whose size has a null value and that may stand beside those of the
// model (MayStandBeside in effects/catalogue.h), in the order of the catalogue, then the laws of
// the user. Contact, which has no derivative at its null value, is tried by pilot_hypotheses.h
// instead.
std::vector<CandidateEffect> MakeCandidates(const CandidateSetting& setting);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_CANDIDATES_H_
