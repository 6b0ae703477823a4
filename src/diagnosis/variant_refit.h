// The refit of an effect in its best variant: at the place, in the direction or with the time scale
// from which a fit comes closest to the measurements.
#ifndef LACUNA_DIAGNOSIS_VARIANT_REFIT_H_
#define LACUNA_DIAGNOSIS_VARIANT_REFIT_H_

#include <limits>

#include "diagnosis/diagnosis_result.h"
#include "diagnosis/effect_refit.h"

namespace lacuna {

// What all refits of a diagnosis share. References must outlive it.
struct RefitContext {
  const BaselineModel& model;
  const EffectRanking& ranking;  // of `model`; its list of effects is not used
};

// A variant of an effect, and the fit of the model with it.
struct VariantRefit {
  ScoredVariant variant;
  EffectRefit refit;
};

// What the best refit of another effect says of a refit that is to be made.
struct RivalRefit {
  // CalibrationOptions::hopeless_cost of the fits.
  double hopeless_cost = std::numeric_limits<double>::infinity();
  // First order leaves the effect further behind than DecisiveLead() (refitted_ranking.h).
  bool is_far_ahead = false;
};

// The log evidence of all frames, up to a constant that all refits share, less the selection
// penalty of the variant. −∞ if the refit is not usable.
double EvidenceOf(const ScoredVariant& variant, const EffectRefit& refit, const NoiseLevel& noise);

// Refits an effect from its best variants, and from a fixed size where that seems to end in a local
// minimum. The best of these fits goes on if it has not converged (ContinueWithinBudget). Where the
// rival is far ahead and the first of these fits was ended as hopeless, it is the only one. The
// predictions of a refit (Calibration::predictions) include those that have found its start.
// `without`: the refit with the same nuisances alone. `is_found`: another refit has come down to
// the noise, which shows that first order leads to the right minimum; a model that is far off is
// then not fitted afresh with this effect. Throws Interrupted.
VariantRefit RefitEffect(const RefitContext& context, const AdoptedNuisances& adopted,
                         const EffectRefit& without, bool is_found, const ScoredEffect& effect,
                         const RivalRefit& rival = {});

// Makes this the refit of an effect. All that RankedEffect says of a refit is replaced at once, so
// that the variant, the sizes, the errors and the values from which the model is fitted again
// belong to one fit. The evidence, which depends on the noise, is 0 until it is weighed.
void SetRefit(ScoredVariant variant, const EffectRefit& refit, RankedEffect* effect);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_VARIANT_REFIT_H_
