// The effects of a ranking with their refits, and how far a refit is behind the best one.
//
// All state is in plain values. refits.h adds refits, refit_comparison.h computes their evidence,
// and nuisance_refits.h adds the fits with a nuisance.
#ifndef LACUNA_DIAGNOSIS_REFITTED_RANKING_H_
#define LACUNA_DIAGNOSIS_REFITTED_RANKING_H_

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/linear_evidence.h"
#include "diagnosis/decision_input.h"
#include "diagnosis/diagnosis_result.h"
#include "diagnosis/effect_ranking.h"
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

// The ranking along the motion of the refit with one effect, whose columns stand beside all refits.
struct AlongRefit {
  std::string type;                              // of that effect
  std::shared_ptr<const EffectRanking> ranking;  // not null
  // The ranking beside which the refits with other effects stand: it also has that effect among the
  // hypotheses, with the columns of the baseline. Not null.
  std::shared_ptr<const EffectRanking> for_others;
};

// The refit with the most evidence of those that the held-out frames do not refute, which is more
// than the model without an effect has; with the noise of the ranking.
struct BestRefit {
  size_t effect = 0;      // index of its effect in the ranking
  double evidence = 0;    // EvidenceBeyondBaseline()
  double underrated = 0;  // by how much first order has underrated it
};

// The effects of a ranking with their refits. A refit is usable if its effect is marked as refitted
// and has no message. All refits stand beside the same columns.
struct RefittedRanking {
  EffectRefit baseline;               // the model with the adopted nuisances
  std::vector<RankedEffect> effects;  // by their evidence beside the baseline, the best first
  std::vector<EffectRefit> refits;    // of the effects, in the same order; empty if not refitted
  int count = 0;                      // number of refits
  int limit = 0;                      // the largest number of refits
  double baseline_evidence = 0;       // of the model without an effect, with the ranking's noise
  std::optional<BestRefit> best;      // nothing: none has more than that; found anew by LookAlong()
  std::optional<AlongRefit> along;  // nothing: the columns of the baseline stand beside all refits
  std::vector<FittedPair> pairs;    // beside the same columns
  std::vector<std::array<std::string, 2>> failed_pairs;  // could not be fitted beside them
  std::map<size_t, EffectRefit> nuisances;               // fits with a nuisance, by its index

  bool IsUsable(size_t effect) const { return effects[effect].HasUsableRefit(); }
  // The index of the effect of this type; nothing if it has no usable refit.
  std::optional<size_t> FindUsable(const std::string& type) const;
  // The evidence of the best refit; 0 if there is none.
  double BestEvidence() const { return best ? best->evidence : 0; }
  // Makes this the refit of the effect (SetRefit).
  void Take(size_t effect, VariantRefit fitted);
  // Calls Take() if the effect has no usable refit, or one with less evidence. Returns whether it
  // has taken the refit.
  bool TakeIfBetter(size_t effect, VariantRefit fitted, const NoiseLevel& noise);
};

// The noise of the measurements, and the rms of the hypothesis with the smallest residual among the
// model without an effect, the refits and the pairs; refuted ones do not count.
struct RefitNoise {
  NoiseLevel level;
  double least_rms_over_sigma = 0;
};

// By how much an effect must be behind the best refit to be negligible, if that gains so much.
double DecisiveLead(double gain);

// The cost of the fitted frames (Calibration::cost) above which a refit is negligible beside that
// of `effect`; infinite without an effect, or if it has no usable refit. A cost counts in units of
// σ², log evidence in units of the variance v σ² of the noise: a difference of costs is v times the
// log evidence that it costs.
double HopelessCost(const RefittedRanking& ranked, const std::optional<size_t>& effect,
                    const NoiseLevel& noise);

// By how much the log evidence of a refit with an effect exceeds that of the model without one,
// less what the choice among all effects and that of the variant cost. First-order evidence pays
// for the choice in the same way, so that the two may be compared. −∞ if the refit is not usable.
double EvidenceBeyondBaseline(const RefittedRanking& ranked, const ScoredVariant& variant,
                              const EffectRefit& refit, const NoiseLevel& noise);

// Whether a refit is so far behind the best one that it is negligible, even if its evidence rises
// by `gain`.
bool IsFarBehind(const RefittedRanking& ranked, const ScoredVariant& variant,
                 const EffectRefit& refit, const NoiseLevel& noise, double gain = 0);

// Sets whether the held-out frames refute the refit of an effect, and takes it for the best one
// where they do not and it has more evidence than the best one so far. `noise`: of the ranking.
void CompareWithBest(const NoiseLevel& noise, size_t effect, RefittedRanking* ranked);

// The effect with the most evidence after its refit, as WeighRefits() has set it; null: none has
// evidence.
const RankedEffect* BestRefitted(const std::vector<RankedEffect>& effects);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_REFITTED_RANKING_H_
