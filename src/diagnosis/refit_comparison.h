// The evidence of the refits of a diagnosis, each compared with the fit without its effect beside
// the same nuisances.
#ifndef LACUNA_DIAGNOSIS_REFIT_COMPARISON_H_
#define LACUNA_DIAGNOSIS_REFIT_COMPARISON_H_

#include <cstddef>

#include "analysis/linear_evidence.h"
#include "calibration/calibration_problem.h"
#include "diagnosis/diagnosis_result.h"
#include "diagnosis/effect_refit.h"
#include "diagnosis/refitted_ranking.h"
#include "diagnosis/variant_refit.h"

namespace lacuna {

// What a refit with an effect is compared with. References must outlive it.
struct RefitComparison {
  const CalibrationProblem& problem;
  const EffectRefit& without;  // the effect, beside the same nuisances
  NoiseLevel noise;
  size_t rivals;  // number of effects from which the effect was selected
  RefitEvidence before = EvidenceOf(without, noise);
};

// Sets what the comparison says about the refit of an effect.
void SetEvidence(const EffectRefit& with, const RefitComparison& comparison, RankedEffect* effect);

// Whether the held-out frames are compatible with both effects of a pair being missing (Predicts):
// it is compared with the model without an effect and with the usable refits of its two effects
// alone, three tests of which each allows for a third of the false refutations.
bool PairPredicts(const FittedPair& pair, const RefittedRanking& ranked, const NoiseLevel& noise);

// Estimates the noise from the hypothesis with the smallest residual, as in RefitNoise, and
// computes the evidence of all refits. Replaces the results of an earlier call.
RefitNoise WeighRefits(const RefitContext& context, RefittedRanking* ranked);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_REFIT_COMPARISON_H_
