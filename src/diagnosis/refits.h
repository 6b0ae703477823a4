// The refits of a diagnosis: which of the ranked effects are fitted together with the model, and
// what evidence they have afterwards.
//
// All state is in plain values. RefitAll() and RefitAsRankedEarly() add refits to a
// RefittedRanking; LookAlong() fits them anew beside the columns of another motion, and
// RefitAgain() from other values; WeighRefits() computes the evidence of all refits that it has,
// with a noise that is estimated from the best one. "The best effect" is the one with the most of
// that evidence; functions that start from it do nothing if no effect has any.
#ifndef LACUNA_DIAGNOSIS_REFITS_H_
#define LACUNA_DIAGNOSIS_REFITS_H_

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/decision_input.h"
#include "diagnosis/diagnosis_result.h"
#include "diagnosis/effect_refit.h"
#include "diagnosis/variant_refit.h"

namespace lacuna {

// The model fitted with two effects, beside the columns of RefittedRanking::along. It is compared
// with the refit of the first one alone, which stands beside the same columns.
struct FittedPair {
  std::string first;
  RankedEffect second;  // as it was refitted beside the first; its evidence is not set
  EffectRefit both;
  std::vector<ParameterEstimate> sizes_of_first;  // in `both`
  Eigen::VectorXd values_of_first;  // in `both`, of the parameters of the model with it alone

  bool IsOf(const std::string& a, const std::string& b) const {
    return IsSamePair(first, second.scored.candidate.type, a, b);
  }
};

// The effects of a ranking with their refits. A refit is usable if its effect is marked as refitted
// and has no message.
struct RefittedRanking {
  EffectRefit baseline;               // the model with the adopted nuisances
  std::vector<RankedEffect> effects;  // by their evidence beside the baseline, the best first
  std::vector<EffectRefit> refits;    // of the effects, in the same order; empty if not refitted
  int count = 0;                      // number of refits
  int limit = 0;                      // the largest number of refits
  // That of the model without an effect, and by how much the best refit that the held-out frames do
  // not refute exceeds it; with the noise of the ranking. All refits stand beside the same columns,
  // and LookAlong() finds the best one anew.
  double baseline_evidence = 0, best_evidence = 0;
  double underrated = 0;       // by how much first order has underrated the evidence of that refit
  std::optional<size_t> best;  // the effect of that refit
  // The ranking along the motion of the refit with the effect `along_type`, whose columns stand
  // beside all refits; null: those of the baseline do. `along_for_others` has that effect among the
  // hypotheses, with the baseline's columns.
  std::string along_type;
  std::shared_ptr<const EffectRanking> along, along_for_others;
  std::vector<FittedPair> pairs;                         // beside the same columns
  std::vector<std::array<std::string, 2>> failed_pairs;  // could not be fitted
  std::map<size_t, EffectRefit> nuisances;               // fits with a nuisance, by its index

  bool IsUsable(size_t effect) const { return effects[effect].HasUsableRefit(); }
  // The index of the effect of this type; nothing if it has no usable refit.
  std::optional<size_t> FindUsable(const std::string& type) const;
  // Makes this the refit of the effect (SetRefit).
  void Take(size_t effect, VariantRefit fitted);
  // The same where the effect has no usable refit, or one with less evidence. Returns whether it
  // has taken it.
  bool TakeIfBetter(size_t effect, VariantRefit fitted, const NoiseLevel& noise);
};

// The noise of the measurements, and the rms of the hypothesis with the smallest residual among the
// model without an effect, the refits and the pairs; refuted ones do not count.
struct RefitNoise {
  NoiseLevel level;
  double least_rms_over_sigma = 0;
};

// Whether the held-out frames are compatible with both effects of a pair being missing (Predicts):
// it is compared with the model without an effect and with the usable refits of its two effects
// alone, three tests of which each allows for a third of the false refutations.
bool PairPredicts(const FittedPair& pair, const RefittedRanking& ranked, const NoiseLevel& noise);

// By how much an effect must be behind the best refit to be negligible, if that gains so much.
double DecisiveLead(double gain);

// Fits the model without an effect. No effect is refitted yet; `wanted` is the number of refits
// that the user asks for.
RefittedRanking StartRefits(const RefitContext& context, const std::vector<ScoredEffect>& effects,
                            int wanted);

// The `wanted` best effects by first order, and those that are nearly as good.
std::vector<size_t> MostPromising(const std::vector<RankedEffect>& effects, int wanted);

// The effects that may be taken for the best refitted one: those that first order cannot
// distinguish from it, and those of its family.
std::vector<size_t> LookAlikesOfBest(const std::vector<RankedEffect>& effects);

// Refits the effects with these indices that have not been refitted, up to the limit, beside the
// columns of RefittedRanking::along. Effects that another refit has clearly beaten
// (RefitThresholds::beaten_by) are left out, but not those of the best effect's family, unless
// their score comes from a simulation at a finite size: a derivative may give no evidence for the
// member that is really missing.
void RefitAll(const RefitContext& context, const std::vector<size_t>& effects,
              RefittedRanking* ranked);

// Refits the `wanted` best effects of another ranking, `early`, from the places, directions, times
// and sizes that they have there, also those that have been refitted: the better refit counts.
void RefitAsRankedEarly(const RefitContext& context, const std::vector<ScoredEffect>& early,
                        int wanted, RefittedRanking* ranked);

// Puts the columns of `along`, a ranking along the motion of the refit with the effect `type`,
// beside all refits, and fits each of them anew beside these columns, from where it is. Every refit
// that follows the measurements moves like that one, while the baseline, without the effect, may
// move otherwise: its columns of the mesh and the time step are then wrong for all of them, and
// what is wrong looks like a further effect. A refit that is behind the best one by DecisiveLead(),
// beside the old columns and once it has been settled beside the new ones (SettledBeside), is not
// fitted. Neither is one whose fit has failed; both count as not converged. Pairs that were fitted
// beside other columns are dropped. Throws Interrupted.
void LookAlong(const RefitContext& context, const std::string& type, EffectRanking along,
               RefittedRanking* ranked);

// Fits the model with an effect, which has a usable refit, from these values of its parameters,
// beside the columns of RefittedRanking::along, and keeps the better of both fits. Throws
// Interrupted.
void RefitAgain(const RefitContext& context, size_t effect, const Eigen::VectorXd& values,
                const NoiseLevel& noise, RefittedRanking* ranked);

// Estimates the noise from the hypothesis with the smallest residual, as in RefitNoise, and
// computes the evidence of all refits. Replaces the results of an earlier call.
RefitNoise WeighRefits(const RefitContext& context, RefittedRanking* ranked);

// Refits the model with each nuisance that first order puts near the best effect or above it.
void RefitRivalNuisances(const RefitContext& context, RefittedRanking* ranked);

// Sets ScoredNuisance::refitted of the nuisances that were refitted. A refit that has not converged
// has found less than the nuisance can explain, so that first order counts where that is more.
void WeighNuisances(const RefittedRanking& ranked, const RefitNoise& noise,
                    std::vector<ScoredNuisance>* nuisances);

// Refits `wanted` effects, at most, in place of the adopted nuisances.
NuisanceAlternatives RefitInPlaceOfNuisances(const RefitContext& context,
                                             const RefittedRanking& ranked, const RefitNoise& noise,
                                             int wanted);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_REFITS_H_
