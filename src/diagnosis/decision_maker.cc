#include "diagnosis/decision_maker.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "diagnosis/effect_ranking.h"
#include "diagnosis/effect_refit.h"
#include "diagnosis/refit_comparison.h"
#include "effects/catalogue.h"

namespace lacuna {
namespace {

// The length of a vector is determined if its mean exceeds so many standard deviations.
constexpr double kDeterminedLength = 3;

// Whether any effect would stand out from the noise at its largest plausible size.
bool IsAnythingDetectable(const std::vector<RankedEffect>& ranking) {
  for (const RankedEffect& effect : ranking) {
    const std::vector<CandidateAmount> amounts = AmountsOf(effect.scored.candidate);
    for (size_t k = 0; k < amounts.size(); ++k)
      if (effect.scored.score.detectable[static_cast<Eigen::Index>(k)] < amounts[k].plausible)
        return true;
  }
  return false;
}

// The evidence for the value that nature gives to an effect's size; 0 where it gives none.
double EvidenceOfNaturalValue(const CandidateEffect& candidate,
                              const std::vector<ParameterEstimate>& sizes) {
  if (candidate.effect == nullptr || sizes.size() != 3) return 0;
  const EffectCard& card = candidate.effect->Card();
  if (card.natural_magnitude == 0) return 0;
  Eigen::Vector3d mean, deviation;
  for (int k = 0; k < 3; ++k) {
    const ParameterEstimate& size = sizes[static_cast<size_t>(k)];
    mean[k] = size.value;
    deviation[k] = size.posterior_deviation;
  }
  if (!deviation.allFinite()) return 0;
  const double prior = AmountsOf(candidate).front().plausible;
  return NaturalValueEvidence(mean, deviation, prior, card.natural_magnitude);
}

// Makes the spaces along the refits. Spaces with the same hypotheses beside them that are made one
// after another share their whitened columns. References must outlive it.
class SpaceMaker {
 public:
  SpaceMaker(const RefittedRanking& ranked, const EffectRanking& ranking, const NoiseLevel& noise)
      : ranked_(ranked), ranking_(ranking), noise_(noise) {}

  // The space along the model without an effect.
  HypothesisSpace OfBaseline() { return Beside(ranked_.baseline.hypothesis, ranking_, {}); }
  // The space along the refit of an effect, or of two.
  HypothesisSpace Along(const FittedHypothesis& hypothesis, std::vector<std::string> types) {
    if (!ranked_.along) return Beside(hypothesis, ranking_, types);
    const auto along = std::find(types.begin(), types.end(), ranked_.along->type);
    if (along == types.end()) return Beside(hypothesis, *ranked_.along->for_others, types);
    // The ranking along its motion may have this effect a second time.
    types.erase(along);
    return Beside(hypothesis, *ranked_.along->ranking, types);
  }

 private:
  HypothesisSpace Beside(const FittedHypothesis& hypothesis, const EffectRanking& ranking,
                         const std::vector<std::string>& types) {
    const LinearisedMisfit& misfit = hypothesis.misfit;
    if (!latest_ || &latest_->ranking() != &ranking || !latest_->WhitensLike(misfit)) {
      latest_.reset();  // before the next one is made: it may be large
      latest_.emplace(ranking, misfit, noise_);
    }
    return latest_->Beside(misfit, misfit.jacobian, hypothesis.priors, types);
  }

  const RefittedRanking& ranked_;
  const EffectRanking& ranking_;
  const NoiseLevel& noise_;
  std::optional<WhitenedHypotheses> latest_;
};

// Nothing if the first effect has no usable refit, or if the evidence is not a finite number.
std::optional<WeighedPair> Weigh(const FittedPair& pair, const RefittedRanking& ranked,
                                 const NoiseLevel& noise, SpaceMaker* spaces) {
  const std::optional<size_t> first = ranked.FindUsable(pair.first);
  if (!first) return std::nullopt;
  const RankedEffect& alone = ranked.effects[*first];
  const EffectRefit& of_first = ranked.refits[*first];
  const double gain = EvidenceOf(pair.both, noise).all - EvidenceOf(of_first, noise).all -
                      pair.second.scored.selection_penalty +
                      EvidenceOfNaturalValue(pair.second.scored.candidate, pair.second.sizes) +
                      EvidenceOfNaturalValue(alone.scored.candidate, pair.sizes_of_first) -
                      EvidenceOfNaturalValue(alone.scored.candidate, alone.sizes);
  if (!std::isfinite(gain)) return std::nullopt;
  const std::string& second = pair.second.scored.candidate.type;
  return WeighedPair{pair.first, second, gain,
                     spaces->Along(pair.both.hypothesis, {pair.first, second}),
                     PairPredicts(pair, ranked, noise)};
}

}  // namespace

double NaturalValueEvidence(const Eigen::Vector3d& mean, const Eigen::Vector3d& deviation,
                            double prior, double natural) {
  const double length = mean.norm();
  const double radial = (mean / std::max(length, 1e-300)).cwiseProduct(deviation).norm();
  if (!(radial > 0) || length < kDeterminedLength * deviation.maxCoeff()) return 0;
  // The density of the posterior on the sphere, whose curvature is small beside the deviations,
  // over that of the normal prior there.
  const double on_sphere = -0.5 * std::pow((natural - length) / radial, 2) -
                           std::log(radial * std::sqrt(2 * std::numbers::pi)) -
                           std::log(4 * std::numbers::pi * natural * natural);
  const double before =
      -0.5 * std::pow(natural / prior, 2) - 3 * std::log(prior * std::sqrt(2 * std::numbers::pi));
  const double factor = on_sphere - before;
  const double largest = std::max(factor, 0.0);
  return largest + std::log(0.5 * std::exp(-largest) + 0.5 * std::exp(factor - largest));
}

DecisionInput MakeDecisionInput(const RefitContext& context, const RefittedRanking& ranked,
                                const RefitNoise& noise,
                                const std::vector<ScoredNuisance>& nuisances) {
  SpaceMaker spaces(ranked, context.ranking, noise.level);
  DecisionInput input;
  input.baseline = spaces.OfBaseline();
  for (size_t k = 0; k < ranked.effects.size(); ++k) {
    const RankedEffect& effect = ranked.effects[k];
    const CandidateEffect& candidate = effect.scored.candidate;
    if (candidate.effect != nullptr)
      input.families[candidate.type] = candidate.effect->Card().family;
    if (!ranked.IsUsable(k)) continue;
    input.refits.push_back({candidate.type, effect.evidence + effect.penalty_of_effects,
                            spaces.Along(ranked.refits[k].hypothesis, {candidate.type}),
                            effect.predicts});
    if (const double natural = EvidenceOfNaturalValue(candidate, effect.sizes); natural != 0)
      input.natural_value[candidate.type] = natural;
  }
  for (const FittedPair& pair : ranked.pairs)
    if (std::optional<WeighedPair> weighed = Weigh(pair, ranked, noise.level, &spaces))
      input.pairs.push_back(*std::move(weighed));
  input.failed_pairs = ranked.failed_pairs;
  for (const ScoredNuisance& nuisance : nuisances) {
    const std::string& name = nuisance.candidate.card.name;
    if (nuisance.adopted && !nuisance.candidate.card.is_always_in_model &&
        std::count(input.adopted.begin(), input.adopted.end(), name) == 0)
      input.adopted.push_back(name);
    if (nuisance.refitted)
      input.nuisances.push_back({name, *nuisance.refitted + SelectionPenalty(nuisances.size())});
  }
  if (!input.adopted.empty()) {
    // To first order, against the parameters and the nuisances that every model has.
    for (const ScoredNuisance& nuisance : nuisances)
      if (nuisance.adopted && !nuisance.candidate.card.is_always_in_model)
        input.adopted_evidence += std::max(0.0, nuisance.evidence);
  }
  input.explained_misfit = context.model.problem.study().explained_misfit;
  input.noise_is_known = context.model.problem.LeastNoiseVariance() == 1;
  input.is_anything_detectable = IsAnythingDetectable(ranked.effects);
  return input;
}

void AddAlternatives(const NuisanceAlternatives& alternatives, DecisionInput* input) {
  if (alternatives.nuisances_evidence == 0) return;
  input->adopted_evidence = alternatives.nuisances_evidence;
  for (size_t k = 0; k < alternatives.effects.size(); ++k) {
    const RankedEffect& effect = alternatives.effects[k];
    if (effect.HasUsableRefit())
      input->in_place_of_adopted.push_back({effect.scored.candidate.type,
                                            effect.evidence + effect.penalty_of_effects,
                                            alternatives.spaces[k], effect.predicts});
  }
}

}  // namespace lacuna
