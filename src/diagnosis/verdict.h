// The verdict of a diagnosis: what its evidence and errors allow to conclude.
//
// Only decisions are made here; report/verdict_text.h puts them into words. All thresholds are in
// diagnosis/thresholds.h, and docs/diagnosis.md explains them.
#ifndef LACUNA_DIAGNOSIS_VERDICT_H_
#define LACUNA_DIAGNOSIS_VERDICT_H_

#include "diagnosis/diagnosis_result.h"

namespace lacuna {

// The evidence for an effect that an uncertain discretisation could account for, where
// `uncertain_evidence` is what lies along the uncertain direction
// (ScoredNuisance::uncertain_evidence).
double DiscretisationUncertainty(double uncertain_evidence);

// Sets the conclusion (verdict, effects, reasons, next steps) from everything else.
void Decide(Diagnosis* diagnosis);

// Revises a verdict "nuisance" with Diagnosis::alternatives. Effects that explain the recordings
// nearly as well as the adopted nuisances, and predict better than the model without both, make it
// ambiguous.
void DecideAgainstNuisances(Diagnosis* diagnosis);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_VERDICT_H_
