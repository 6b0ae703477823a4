#include "diagnosis/decision.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "diagnosis/adequacy.h"
#include "diagnosis/decision_rules.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

using Kind = HypothesisProbability::Kind;

size_t CountOf(const std::vector<HypothesisProbability>& hypotheses, Kind kind) {
  return static_cast<size_t>(std::count_if(hypotheses.begin(), hypotheses.end(),
                                           [&](const auto& one) { return one.kind == kind; }));
}

const WeighedRefit* FindRefit(const DecisionInput& input, const std::string& effect) {
  for (const WeighedRefit& refit : input.refits)
    if (refit.effect == effect) return &refit;
  return nullptr;
}

// Adopted nuisances are in the base, so that every hypothesis contains them. Hypotheses without
// them are added: effects in their place, and nothing.
void CompareWithAdopted(const DecisionInput& input, double effects,
                        std::vector<HypothesisProbability>* hypotheses) {
  if (input.adopted.empty()) return;
  // The prior probability that there is such a nuisance, and that nothing else is missing.
  const double adopted = input.adopted_evidence + std::log(kPriorNuisances);
  std::vector<HypothesisProbability> in_place;
  for (HypothesisProbability& one : *hypotheses) {
    for (const WeighedRefit& refit : input.in_place_of_adopted) {
      if (one.kind != Kind::kEffect || refit.effect != one.names.front()) continue;
      HypothesisProbability& alone = in_place.emplace_back(one);
      alone.evidence = refit.evidence - effects - input.baseline.model_error;
      alone.is_refuted = !refit.predicts;
    }
    one.evidence += adopted;
    if (one.kind == Kind::kNothing) {
      one.kind = Kind::kNuisance;
      one.evidence += std::log(kPriorNothing / kPriorNuisances);
    }
    one.names.insert(one.names.end(), input.adopted.begin(), input.adopted.end());
  }
  hypotheses->insert(hypotheses->end(), in_place.begin(), in_place.end());
  hypotheses->emplace_back();  // nothing, and no nuisance
}

// First order overrates large effects. The evidence of an effect that was not refitted is reduced
// by the share that the best refit has kept of its own.
double KeptShare(const DecisionInput& input, const std::vector<NamedEvidence>& first_order) {
  const WeighedRefit* best = nullptr;
  for (const WeighedRefit& refit : input.refits)
    if (refit.predicts && refit.evidence > (best != nullptr ? best->evidence : 0)) best = &refit;
  if (best == nullptr) return 1;
  for (const NamedEvidence& named : first_order)
    if (named.name == best->effect && named.evidence > best->evidence)
      return best->evidence / named.evidence;
  return 1;
}

// The posterior over single hypotheses.
std::vector<HypothesisProbability> PosteriorOf(const DecisionInput& input,
                                               const std::vector<NamedEvidence>& first_order) {
  std::vector<HypothesisProbability> hypotheses =
      HypothesesOf(first_order, input.families, input.baseline.model_error);
  const double share = KeptShare(input, first_order);
  const double effects = std::log(static_cast<double>(CountOf(hypotheses, Kind::kEffect)));
  const double nuisances = std::log(static_cast<double>(CountOf(hypotheses, Kind::kNuisance)));
  for (HypothesisProbability& one : hypotheses) {
    if (one.kind == Kind::kEffect) {
      const WeighedRefit* refit = FindRefit(input, one.names.front());
      one.is_refuted = refit != nullptr && !refit->predicts;
      if (refit != nullptr)
        one.evidence = refit->evidence - effects - input.baseline.model_error;
      else if (one.evidence > 0)
        one.evidence *= share;
      if (const auto natural = input.natural_value.find(one.names.front());
          natural != input.natural_value.end())
        one.evidence += natural->second;
    } else if (one.kind == Kind::kNuisance) {
      // Of those of one name, one for each recording or grip, the best.
      double refitted = -std::numeric_limits<double>::infinity();
      for (const WeighedNuisance& refit : input.nuisances)
        if (refit.name == one.names.front()) refitted = std::max(refitted, refit.evidence);
      if (std::isfinite(refitted)) one.evidence = refitted - nuisances;
    }
  }
  CompareWithAdopted(input, effects, &hypotheses);
  SetPosterior(&hypotheses);
  return hypotheses;
}

// The space in which a hypothesis is tested, and its columns there beside the base.
struct TestedSpace {
  const HypothesisSpace* space;
  std::vector<int> columns;
};

TestedSpace SpaceOf(const DecisionInput& input, const std::vector<NamedEvidence>& first_order,
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

// Adds to the columns of a hypothesis with an effect those of the nuisances that explain the
// residual beside it: a clamp is never exactly where it was measured, and a large effect must not
// turn that error into something unknown. Each is more probable than no nuisance, and leads over
// every further effect as a nuisance that enters the model does. Returns their names.
std::vector<std::string> TakeNuisancesBeside(TestedSpace* tested) {
  std::vector<std::string> taken;
  const HypothesisSpace& space = *tested->space;
  for (int count = 0; count < kThresholds.ranking.most_adopted_nuisances; ++count) {
    const ProjectedHypotheses beside(space, tested->columns);
    const NamedEvidence* best = nullptr;
    double effect = 0;
    const std::vector<NamedEvidence> further =
        SumVariants(space, beside.LogBayesFactors(beside.Project(space.model.toward())));
    for (const NamedEvidence& named : further) {
      if (named.kind == HypothesisKind::kEffect)
        effect = std::max(effect, named.evidence);
      else if (best == nullptr || named.evidence > best->evidence)
        best = &named;
    }
    const double least = std::max(space.model_error + std::log(kPriorNothing / kPriorNuisances),
                                  effect + kThresholds.ranking.nuisance_lead);
    if (best == nullptr || !(best->evidence > least)) break;
    const std::vector<int>& columns = space.hypotheses[best->best].columns;
    tested->columns.insert(tested->columns.end(), columns.begin(), columns.end());
    taken.push_back(best->name);
  }
  return taken;
}

// The log Bayes factor that the best effect exceeds in one of twenty recordings in which nothing is
// missing. NaN where there is no effect.
double ChanceOf(const DecisionInput& input, const ProjectedHypotheses& beside_nothing) {
  constexpr int kDraws = 400;
  const NoiseDraws noise(input.baseline);
  std::vector<double> best;
  for (int k = 0; k < kDraws; ++k) {
    const ResidualProducts draw = noise.Draw(input.seed + 1, static_cast<uint64_t>(k));
    double largest = -std::numeric_limits<double>::infinity();
    for (const NamedEvidence& named : SumVariants(
             input.baseline, beside_nothing.LogBayesFactors(beside_nothing.Project(draw.toward))))
      if (named.kind == HypothesisKind::kEffect) largest = std::max(largest, named.evidence);
    best.push_back(largest);
  }
  std::sort(best.begin(), best.end());
  const double chance = best[static_cast<size_t>(0.95 * kDraws)];
  return std::isfinite(chance) ? chance : std::numeric_limits<double>::quiet_NaN();
}

// `removed`: the misfit, σ², that the hypothesis and the effects added before have removed.
RecordedAdequacy RecordOf(const AdequacyTest& test, double removed,
                          std::vector<std::string> beside) {
  RecordedAdequacy adequacy;
  adequacy.beside = std::move(beside);
  adequacy.p_unknown_force = test.p_unknown_force;
  adequacy.p_further = test.p_further;
  adequacy.p_variance = test.p_variance;
  adequacy.p = test.p;
  adequacy.is_adequate = test.p >= kAdequacyLevel || !test.IsSupported();
  adequacy.further = test.found.best_further.name;
  adequacy.further_evidence = test.found.further;
  adequacy.rms_over_sigma = std::sqrt(std::max(0.0, test.found.variance));
  adequacy.left_share = removed > 0 ? std::max(0.0, test.found.left) / removed
                                    : std::numeric_limits<double>::infinity();
  adequacy.is_tolerated = adequacy.left_share < kToleratedModelError;
  return adequacy;
}

// An effect with the evidence of everything else beside it.
struct EffectWithFurther {
  std::string effect;
  double evidence = 0;  // of the effect against the model as it is
  TestedSpace tested;
  std::vector<NamedEvidence> further;

  // The evidence of this effect together with a further one that has this evidence beside it.
  // Either of the two may be found first.
  double With(double second) const {
    return evidence + second - tested.space->model_error + std::log(2.0);
  }
};

// Two effects that may be missing together, with the space in which both are tested.
struct Pair {
  HypothesisProbability hypothesis;
  TestedSpace tested;
};

// The effects of the posterior that may be the first of a pair: those that were refitted, and the
// most probable one.
std::vector<EffectWithFurther> FirstEffects(const DecisionInput& input,
                                            const std::vector<NamedEvidence>& first_order,
                                            const std::vector<HypothesisProbability>& posterior) {
  std::vector<EffectWithFurther> effects;
  for (const HypothesisProbability& first : posterior) {
    if (first.kind != Kind::kEffect || first.is_refuted) continue;
    if (first.names.size() != 1 + input.adopted.size()) continue;  // in place of adopted nuisances
    if (FindRefit(input, first.names.front()) == nullptr && &first != &posterior.front()) continue;
    const TestedSpace tested = SpaceOf(input, first_order, first);
    const ProjectedHypotheses beside(*tested.space, tested.columns);
    const Eigen::VectorXd factors =
        beside.LogBayesFactors(beside.Project(tested.space->model.toward()));
    effects.push_back(
        {first.names.front(), first.evidence, tested, SumVariants(*tested.space, factors)});
  }
  return effects;
}

Pair MakePair(const DecisionInput& input, const std::string& first, const std::string& second,
              double evidence, TestedSpace tested) {
  Pair pair;
  pair.hypothesis.kind = Kind::kPair;
  pair.hypothesis.names = {first, second};
  pair.hypothesis.names.insert(pair.hypothesis.names.end(), input.adopted.begin(),
                               input.adopted.end());
  pair.hypothesis.evidence = evidence;
  pair.tested = std::move(tested);
  return pair;
}

// The pairs that the decision weighs: those that were fitted and whose first effect is not refuted,
// and each first effect with the best further effect beside it. The further effect is weighed to
// first order, so that it may replace a part of the first one although only one of them is missing.
// Where both were refitted, the smaller of the two estimates therefore counts.
std::vector<Pair> PairsOf(const DecisionInput& input, const std::vector<NamedEvidence>& first_order,
                          const std::vector<HypothesisProbability>& posterior) {
  const std::vector<EffectWithFurther> effects = FirstEffects(input, first_order, posterior);
  const auto is_refuted = [&](const std::string& effect) {
    const WeighedRefit* refit = FindRefit(input, effect);
    return refit != nullptr && !refit->predicts;
  };
  std::vector<Pair> pairs;
  for (const WeighedPair& refit : input.pairs)
    for (const EffectWithFurther& first : effects) {
      if (first.effect != refit.first) continue;
      const double second = refit.gain - std::log(static_cast<double>(input.families.size()));
      pairs.push_back(
          MakePair(input, refit.first, refit.second, first.With(second), {&refit.space, {}}));
      pairs.back().hypothesis.is_refuted = !refit.predicts || is_refuted(refit.second);
    }
  for (const EffectWithFurther& first : effects) {
    const std::string& name = first.effect;
    const NamedEvidence* second = nullptr;
    for (const NamedEvidence& named : first.further)
      if (named.kind == HypothesisKind::kEffect && named.name != name && !is_refuted(named.name) &&
          (second == nullptr || named.evidence > second->evidence))
        second = &named;
    // The error of the first effect's model may give so much evidence to any other effect.
    if (second == nullptr || second->evidence < kToleratedModelError * first.evidence) continue;
    if (std::any_of(pairs.begin(), pairs.end(), [&](const Pair& other) {
          return other.hypothesis.Contains(name) && other.hypothesis.Contains(second->name);
        }))
      continue;
    double evidence = first.With(second->evidence);
    for (const EffectWithFurther& other : effects) {
      if (other.effect != second->name) continue;
      for (const NamedEvidence& named : other.further)
        if (named.name == name) evidence = std::min(evidence, other.With(named.evidence));
    }
    TestedSpace tested = first.tested;
    const std::vector<int>& columns = first.tested.space->hypotheses[second->best].columns;
    tested.columns.insert(tested.columns.end(), columns.begin(), columns.end());
    pairs.push_back(MakePair(input, name, second->name, evidence, std::move(tested)));
  }
  return pairs;
}

}  // namespace

EffectFamily FamilyOf(const std::map<std::string, EffectFamily>& families,
                      const std::string& effect) {
  const auto family = families.find(effect);
  return family != families.end() ? family->second : EffectFamily::kOther;
}

std::vector<HypothesisProbability> HypothesesOf(const std::vector<NamedEvidence>& evidence,
                                                const std::map<std::string, EffectFamily>& families,
                                                double model_error) {
  std::vector<HypothesisProbability> hypotheses(1);  // nothing
  for (const NamedEvidence& named : evidence) {
    HypothesisProbability& one = hypotheses.emplace_back();
    one.kind = named.kind == HypothesisKind::kEffect ? Kind::kEffect : Kind::kNuisance;
    one.names = {named.name};
    one.evidence = named.evidence;
    if (one.kind != Kind::kEffect) continue;
    one.evidence -= model_error;
    one.family = FamilyOf(families, named.name);
  }
  return hypotheses;
}

Decision Decide(const DecisionInput& input) {
  const ProjectedHypotheses beside_nothing(input.baseline);
  const std::vector<NamedEvidence> first_order = SumVariants(
      input.baseline,
      beside_nothing.LogBayesFactors(beside_nothing.Project(input.baseline.model.toward())));
  Decision decision;
  DecisionRecord& record = decision.record;
  record.probabilities = PosteriorOf(input, first_order);
  const std::vector<Pair> pairs = PairsOf(input, first_order, record.probabilities);
  for (const Pair& pair : pairs) record.probabilities.push_back(pair.hypothesis);
  SetPosterior(&record.probabilities);
  const HypothesisProbability& best = record.probabilities.front();
  TestedSpace tested = SpaceOf(input, first_order, best);
  for (const Pair& pair : pairs)
    if (pair.hypothesis.names == best.names) tested = pair.tested;
  std::vector<std::string> beside = best.names.empty() ? input.adopted : best.names;
  if (best.kind == Kind::kEffect || best.kind == Kind::kPair)
    for (const std::string& nuisance : TakeNuisancesBeside(&tested))
      if (std::count(beside.begin(), beside.end(), nuisance) == 0) beside.push_back(nuisance);
  const AdequacyTest test =
      TestAdequacy(*tested.space, tested.columns, input.noise_is_known, input.seed);
  record.adequacy = RecordOf(test, 2 * best.evidence + input.explained_misfit, std::move(beside));
  record.chance = ChanceOf(input, beside_nothing);

  const Naming naming = NameFrom(record.probabilities);
  decision.names = naming.names;
  const auto is_nuisance = [&](const std::string& name) {
    return IsNuisance(record.probabilities, name);
  };
  if (!record.adequacy.is_adequate && !record.adequacy.is_tolerated) {
    decision.verdict = Verdict::kNotInLibrary;
  } else if (naming.level == Naming::Level::kNothing) {
    decision.verdict = input.is_anything_detectable ? Verdict::kAdequate : Verdict::kNoPower;
  } else if (std::all_of(naming.names.begin(), naming.names.end(), is_nuisance)) {
    decision.verdict = Verdict::kNuisance;
  } else if (naming.level == Naming::Level::kCommon) {
    decision.verdict = Verdict::kMissing;
    std::erase_if(decision.names, is_nuisance);
  } else {
    decision.verdict = Verdict::kAmbiguous;
  }
  return decision;
}

}  // namespace lacuna
