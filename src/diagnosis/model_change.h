// Prediction studies whose model contains one more effect, or another elasticity law.
//
// WithCandidate() and WithEffect() return a new study and leave the given one as it is. The
// parameters of the result are those of the given study, in their order, followed by the added
// ones.
#ifndef LACUNA_DIAGNOSIS_MODEL_CHANGE_H_
#define LACUNA_DIAGNOSIS_MODEL_CHANGE_H_

#include "diagnosis/candidate_effect.h"
#include "diagnosis/scored_effect.h"
#include "prediction/prediction_study.h"

namespace lacuna {

// The study with the candidate's own effect, none of whose parameters is fitted. An elasticity law
// replaces the law of the model and takes over its moduli, including those that are fitted.
// Masses that are added to the body fall with the gravity of the model, also with one that is
// added, except masses that had a gravity of their own in a model without it.
PredictionStudy WithCandidate(const PredictionStudy& study, const CandidateEffect& candidate);

// The values of the effect's parameters at which its refit starts: the size that first order
// predicts, within its plausible range, but not the null value; a pilot is at its pilot setting.
Eigen::VectorXd StartOfRefit(const ScoredVariant& scored);

// The study with the effect at StartOfRefit(). All of its parameters that the candidate does not
// hold are fitted, within a margin of the plausible range of its card, so that a wrong effect
// cannot imitate another one at an implausible size. The effect is a copy, not shared with
// `scored`.
PredictionStudy WithEffect(const PredictionStudy& study, const ScoredVariant& scored);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_MODEL_CHANGE_H_
