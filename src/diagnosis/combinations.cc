#include "diagnosis/combinations.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/decision_rules.h"
#include "diagnosis/projected_hypotheses.h"
#include "effects/catalogue.h"

namespace lacuna {
namespace {

using Kind = HypothesisProbability::Kind;

// An effect with the evidence of everything else beside it.
struct EffectWithFurther {
  HypothesisProbability alone;
  // The evidence that the error of this effect's model may give to anything else. An earlier
  // diagnosis would have written twice the evidence of the effect into the model as explained
  // misfit, so that this is what it would add to HypothesisSpace::model_error.
  double model_error = 0;
  TestedSpace tested;
  std::vector<NamedEvidence> further;

  const std::string& Name() const { return alone.names.front(); }
  // What a further hypothesis that has this evidence beside the effect gains beyond what may be
  // error of the model.
  double GainOf(double second) const { return second - tested.space->model_error - model_error; }
  // The evidence of this effect together with the effect `name`. Either of two different ones may
  // be found first.
  double With(const std::string& name, double second) const {
    return alone.evidence + GainOf(second) + (name == Name() ? 0 : std::log(2.0));
  }
};

// The effects of the posterior that may be the first of a combination: those that were refitted,
// and the most probable one.
std::vector<EffectWithFurther> FirstEffects(const DecisionInput& input,
                                            const std::vector<NamedEvidence>& first_order,
                                            const std::vector<HypothesisProbability>& posterior) {
  std::vector<EffectWithFurther> effects;
  for (const HypothesisProbability& first : posterior) {
    if (first.kind != Kind::kEffect) continue;
    if (first.names.size() != 1 + input.adopted.size()) continue;  // in place of adopted nuisances
    if (FindRefit(input, first.names.front()) == nullptr && &first != &posterior.front()) continue;
    const TestedSpace tested = TestedSpaceOf(input, first_order, first);
    const ProjectedHypotheses beside(*tested.space, tested.columns);
    const double own = first.evidence - EvidenceOfAdopted(input);
    effects.push_back({first, kToleratedModelError * std::max(0.0, own), tested,
                       SumVariants(*tested.space, beside.FactorsOfResidual())});
  }
  return effects;
}

const EffectWithFurther* FindFirst(const std::vector<EffectWithFurther>& effects,
                                   const std::string& name) {
  for (const EffectWithFurther& effect : effects)
    if (effect.Name() == name) return &effect;
  return nullptr;
}

Combination Combine(const DecisionInput& input, Kind kind, const std::string& first,
                    const std::string& second, double evidence, TestedSpace tested) {
  Combination both;
  both.hypothesis.kind = kind;
  both.hypothesis.names = {first, second};
  both.hypothesis.names.insert(both.hypothesis.names.end(), input.adopted.begin(),
                               input.adopted.end());
  both.hypothesis.evidence = evidence;
  both.tested = std::move(tested);
  return both;
}

// The space in which an effect is tested, with the columns of a further hypothesis beside it.
TestedSpace TestedBeside(const EffectWithFurther& first, const NamedEvidence& further) {
  TestedSpace tested = first.tested;
  const std::vector<int>& columns = tested.space->hypotheses[further.best].columns;
  tested.columns.insert(tested.columns.end(), columns.begin(), columns.end());
  return tested;
}

bool IsElasticityLaw(const std::string& effect) {
  const CatalogueEntry* entry = FindEntry(effect);
  return entry != nullptr && entry->kind == CatalogueEntry::Kind::kMaterial;
}

// Whether a model may contain the effect twice, e.g. at two places or with two relaxation times.
bool IsRepeatable(const std::string& effect) {
  const CatalogueEntry* entry = FindEntry(effect);
  return entry != nullptr && entry->card->repeatable;
}

const WeighedPair* FindPair(const DecisionInput& input, const std::string& a,
                            const std::string& b) {
  for (const WeighedPair& pair : input.pairs)
    if (IsSamePair(pair.first, pair.second, a, b)) return &pair;
  return nullptr;
}

// Whether two effects, or one effect twice, may be missing together: a model has one elasticity
// law, and a pair that could not be fitted, or that the held-out frames have refuted, is not
// weighed to first order again.
bool MayBeBoth(const DecisionInput& input, const std::string& a, const std::string& b) {
  if ((a == b && !IsRepeatable(a)) || (IsElasticityLaw(a) && IsElasticityLaw(b)) ||
      HasFailed(input, a, b))
    return false;
  const WeighedPair* fitted = FindPair(input, a, b);
  return fitted == nullptr || fitted->predicts;
}

// The further effect that explains most beside the first one, to first order; null where it gains
// nothing, or where the two have been fitted together.
const NamedEvidence* BestFurther(const DecisionInput& input, const EffectWithFurther& first) {
  const NamedEvidence* best = nullptr;
  for (const NamedEvidence& named : first.further)
    if (named.kind == HypothesisKind::kEffect && MayBeBoth(input, first.Name(), named.name) &&
        (best == nullptr || named.evidence > best->evidence))
      best = &named;
  const bool is_open = best != nullptr && first.GainOf(best->evidence) > 0 &&
                       FindPair(input, first.Name(), best->name) == nullptr;
  return is_open ? best : nullptr;
}

// The pairs that were fitted. The prediction of each is judged by itself: if both effects are
// missing, the model with one of them is not the truth, and may predict worse than none. Whichever
// of the two is found first, the other must gain more than the error of that one's model.
std::vector<Combination> FittedPairs(const DecisionInput& input,
                                     const std::vector<EffectWithFurther>& effects) {
  std::vector<Combination> pairs;
  for (const WeighedPair& refit : input.pairs) {
    const EffectWithFurther* first = FindFirst(effects, refit.first);
    const EffectWithFurther* second = FindFirst(effects, refit.second);
    if (first == nullptr) continue;
    double evidence = first->With(
        refit.second, refit.gain - std::log(static_cast<double>(input.families.size())));
    if (second != nullptr) evidence -= std::max(0.0, second->model_error - first->model_error);
    pairs.push_back(
        Combine(input, Kind::kPair, refit.first, refit.second, evidence, {&refit.space, {}}));
    pairs.back().hypothesis.is_refuted = !refit.predicts;
  }
  return pairs;
}

// Adds each first effect with the best further effect beside it, weighed to first order. The
// further effect may replace a part of the first one although only one of them is missing. Where
// both were refitted, the smaller of the two estimates therefore counts. A refuted effect may be
// the second one, but not the first: only a fit can show that a further effect mends its
// prediction, and until then every further effect would seem to.
void AddPairsToFirstOrder(const DecisionInput& input, const std::vector<EffectWithFurther>& effects,
                          std::vector<Combination>* pairs) {
  for (const EffectWithFurther& first : effects) {
    if (first.alone.is_refuted) continue;
    const std::string& name = first.Name();
    const NamedEvidence* second = BestFurther(input, first);
    if (second == nullptr) continue;
    if (std::any_of(pairs->begin(), pairs->end(), [&](const Combination& other) {
          return IsSamePair(other.hypothesis.names[0], other.hypothesis.names[1], name,
                            second->name);
        }))
      continue;
    double evidence = first.With(second->name, second->evidence);
    if (const EffectWithFurther* other = FindFirst(effects, second->name))
      for (const NamedEvidence& named : other->further)
        if (named.kind == HypothesisKind::kEffect && named.name == name)
          evidence = std::min(evidence, other->With(name, named.evidence));
    pairs->push_back(
        Combine(input, Kind::kPair, name, second->name, evidence, TestedBeside(first, *second)));
  }
}

// Each first effect with each nuisance beside it, weighed to first order: what an effect leaves may
// be an error of the measurement and not a further effect. Their prior is the product of those of
// the effect and of the nuisance. As long as the best further effect has not been fitted together
// with the first one, the smaller of two estimates counts for that pair; a nuisance is then
// weighed only where it is ahead of what the further effect explains beside the same refit.
std::vector<Combination> WithNuisances(const DecisionInput& input,
                                       const std::vector<EffectWithFurther>& effects,
                                       const std::vector<HypothesisProbability>& posterior) {
  std::vector<Combination> combinations;
  for (const EffectWithFurther& first : effects) {
    if (first.alone.is_refuted) continue;
    const NamedEvidence* rival = BestFurther(input, first);
    for (const NamedEvidence& named : first.further) {
      if (named.kind != HypothesisKind::kNuisance || !IsNuisance(posterior, named.name)) continue;
      const double gain = first.GainOf(named.evidence);
      const double evidence = first.alone.evidence + gain + std::log(kPriorNuisances);
      const bool is_behind =
          rival != nullptr && evidence + std::log(kPriorEffects) <
                                  first.With(rival->name, rival->evidence) + std::log(kPriorPairs);
      if (!(gain > 0) || is_behind) continue;
      combinations.push_back(Combine(input, Kind::kEffect, first.Name(), named.name, evidence,
                                     TestedBeside(first, named)));
      combinations.back().hypothesis.family = first.alone.family;
    }
  }
  return combinations;
}

}  // namespace

const WeighedRefit* FindRefit(const DecisionInput& input, const std::string& effect) {
  for (const WeighedRefit& refit : input.refits)
    if (refit.effect == effect) return &refit;
  return nullptr;
}

bool HasFailed(const DecisionInput& input, const std::string& a, const std::string& b) {
  return std::any_of(input.failed_pairs.begin(), input.failed_pairs.end(),
                     [&](const auto& pair) { return IsSamePair(pair[0], pair[1], a, b); });
}

double EvidenceOfAdopted(const DecisionInput& input) {
  return input.adopted.empty() ? 0 : input.adopted_evidence + std::log(kPriorNuisances);
}

TestedSpace TestedSpaceOf(const DecisionInput& input, const std::vector<NamedEvidence>& first_order,
                          const HypothesisProbability& hypothesis) {
  if (hypothesis.names.empty() || hypothesis.names == input.adopted) return {&input.baseline, {}};
  const std::string& name = hypothesis.names.front();
  if (hypothesis.kind == Kind::kEffect && hypothesis.names.size() == 1 && !input.adopted.empty())
    for (const WeighedRefit& refit : input.in_place_of_adopted)
      if (refit.effect == name) return {&refit.space, {}};
  if (hypothesis.kind == Kind::kEffect)
    if (const WeighedRefit* refit = FindRefit(input, name)) return {&refit->space, {}};
  for (const NamedEvidence& named : first_order)
    if (named.name == name) return {&input.baseline, input.baseline.hypotheses[named.best].columns};
  return {&input.baseline, {}};
}

std::vector<Combination> CombinationsOf(const DecisionInput& input,
                                        const std::vector<NamedEvidence>& first_order,
                                        const std::vector<HypothesisProbability>& posterior) {
  const std::vector<EffectWithFurther> effects = FirstEffects(input, first_order, posterior);
  std::vector<Combination> combinations = FittedPairs(input, effects);
  AddPairsToFirstOrder(input, effects, &combinations);
  for (Combination& one : WithNuisances(input, effects, posterior))
    combinations.push_back(std::move(one));
  return combinations;
}

}  // namespace lacuna
