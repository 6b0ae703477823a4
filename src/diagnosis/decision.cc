#include "diagnosis/decision.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "diagnosis/adequacy.h"
#include "diagnosis/combinations.h"
#include "diagnosis/decision_rules.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

using Kind = HypothesisProbability::Kind;

size_t CountOf(const std::vector<HypothesisProbability>& hypotheses, Kind kind) {
  return static_cast<size_t>(std::count_if(hypotheses.begin(), hypotheses.end(),
                                           [&](const auto& one) { return one.kind == kind; }));
}

// What a natural value adds to the evidence of an effect.
double NaturalValueOf(const DecisionInput& input, const std::string& effect) {
  const auto natural = input.natural_value.find(effect);
  return natural != input.natural_value.end() ? natural->second : 0;
}

// Adopted nuisances are in the base, so that every hypothesis contains them. Alone they have the
// prior of a nuisance, like one that was not adopted; beside something else, the product of the two
// priors. Hypotheses without them are added: effects in their place, and nothing.
void CompareWithAdopted(const DecisionInput& input, double effects,
                        std::vector<HypothesisProbability>* hypotheses) {
  if (input.adopted.empty()) return;
  std::vector<HypothesisProbability> in_place;
  for (HypothesisProbability& one : *hypotheses) {
    for (const WeighedRefit& refit : input.in_place_of_adopted) {
      if (one.kind != Kind::kEffect || refit.effect != one.names.front()) continue;
      HypothesisProbability& alone = in_place.emplace_back(one);
      alone.evidence = refit.evidence - effects - input.baseline.model_error +
                       NaturalValueOf(input, refit.effect);
      alone.is_refuted = !refit.predicts;
    }
    if (one.kind == Kind::kNothing) {
      one.kind = Kind::kNuisance;
      one.evidence += input.adopted_evidence;
    } else {
      one.evidence += EvidenceOfAdopted(input);
    }
    one.names.insert(one.names.end(), input.adopted.begin(), input.adopted.end());
  }
  hypotheses->insert(hypotheses->end(), in_place.begin(), in_place.end());
  hypotheses->emplace_back();  // nothing, and no nuisance
}

// First order overrates large effects. The evidence of an effect that was not refitted is reduced
// by the share that the best refit has kept of its own. `effects`: ln n, which the evidence to
// first order has given up already.
double KeptShare(const DecisionInput& input, const std::vector<NamedEvidence>& first_order,
                 double effects) {
  const WeighedRefit* best = nullptr;
  for (const WeighedRefit& refit : input.refits)
    if (refit.predicts && (best == nullptr || refit.evidence > best->evidence)) best = &refit;
  if (best == nullptr) return 1;
  const double kept = best->evidence - effects;
  if (!(kept > 0)) return 1;
  for (const NamedEvidence& named : first_order)
    if (named.kind == HypothesisKind::kEffect && named.name == best->effect &&
        named.evidence > kept)
      return kept / named.evidence;
  return 1;
}

// The log Bayes factor of a nuisance of which there may be several of one name, one for each
// recording or grip: the mean of their Bayes factors, because each is as probable as the others. Of
// those the best were refitted; the others count for nothing. Empty: none was refitted.
std::optional<double> RefittedEvidence(const DecisionInput& input, const std::string& nuisance) {
  std::vector<double> refitted;
  for (const WeighedNuisance& refit : input.nuisances)
    if (refit.name == nuisance && std::isfinite(refit.evidence)) refitted.push_back(refit.evidence);
  if (refitted.empty()) return std::nullopt;
  size_t tried = 0;
  for (const WeighedHypothesis& one : input.baseline.hypotheses)
    tried += one.kind == HypothesisKind::kNuisance && one.name == nuisance;
  const double largest = *std::max_element(refitted.begin(), refitted.end());
  double sum = 0;
  for (const double evidence : refitted) sum += std::exp(evidence - largest);
  return largest + std::log(sum / static_cast<double>(std::max(tried, refitted.size())));
}

// The posterior over single hypotheses.
std::vector<HypothesisProbability> SinglePosterior(const DecisionInput& input,
                                                   const std::vector<NamedEvidence>& first_order) {
  std::vector<HypothesisProbability> hypotheses =
      HypothesesOf(first_order, input.families, input.baseline.model_error);
  const double effects = std::log(static_cast<double>(CountOf(hypotheses, Kind::kEffect)));
  const double share = KeptShare(input, first_order, effects);
  const double nuisances = std::log(static_cast<double>(CountOf(hypotheses, Kind::kNuisance)));
  for (HypothesisProbability& one : hypotheses) {
    if (one.kind == Kind::kEffect) {
      const WeighedRefit* refit = FindRefit(input, one.names.front());
      one.is_refuted = refit != nullptr && !refit->predicts;
      // An effect is compared with the model without it, whose error along its own motion, that of
      // the baseline, may imitate the effect, whatever columns stand beside the refit.
      const double error = input.baseline.model_error;
      if (refit != nullptr)
        one.evidence = refit->evidence - effects - error;
      else
        one.evidence -= (1 - share) * std::max(0.0, one.evidence + error);
      one.evidence += NaturalValueOf(input, one.names.front());
    } else if (one.kind == Kind::kNuisance) {
      if (const std::optional<double> refitted = RefittedEvidence(input, one.names.front()))
        one.evidence = *refitted - nuisances - input.baseline.model_error;
    }
  }
  CompareWithAdopted(input, effects, &hypotheses);
  SetPosterior(&hypotheses);
  return hypotheses;
}

// The posterior over all hypotheses, and what it was made from.
struct Weighed {
  explicit Weighed(const DecisionInput& input);

  // The most probable part of what was merged into one hypothesis of `posterior`.
  const HypothesisProbability& PartOf(const HypothesisProbability& merged) const;
  // The space and the columns with which such a part is tested.
  TestedSpace Tested(const DecisionInput& input, const HypothesisProbability& part) const;

  ProjectedHypotheses beside_nothing;
  std::vector<NamedEvidence> first_order;
  std::vector<Combination> combinations;
  std::vector<HypothesisProbability> distinguished;  // before repeated ones were merged
  std::vector<HypothesisProbability> posterior;
};

Weighed::Weighed(const DecisionInput& input)
    : beside_nothing(input.baseline),
      first_order(SumVariants(input.baseline, beside_nothing.FactorsOfResidual())) {
  distinguished = SinglePosterior(input, first_order);
  combinations = CombinationsOf(input, first_order, distinguished);
  for (const Combination& both : combinations) distinguished.push_back(both.hypothesis);
  SetPosterior(&distinguished);
  posterior = distinguished;
  MergeRepeated(&posterior);
}

const HypothesisProbability& Weighed::PartOf(const HypothesisProbability& merged) const {
  return *std::find_if(distinguished.begin(), distinguished.end(),
                       [&](const auto& one) { return IsRepeated(one, merged); });
}

TestedSpace Weighed::Tested(const DecisionInput& input, const HypothesisProbability& part) const {
  TestedSpace tested = TestedSpaceOf(input, first_order, part);
  for (const Combination& both : combinations)
    if (both.hypothesis.names == part.names && both.hypothesis.evidence == part.evidence)
      tested = both.tested;
  return tested;
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
    const std::vector<NamedEvidence> further = SumVariants(space, beside.FactorsOfResidual());
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

// The evidence that the best effect exceeds in one of twenty recordings in which nothing is
// missing. NaN where there is no effect.
double ChanceOf(const DecisionInput& input, const ProjectedHypotheses& beside_nothing) {
  constexpr int kDraws = 400;
  const NoiseDraws noise(beside_nothing.Marginal());
  std::vector<double> best;
  for (int k = 0; k < kDraws; ++k) {
    const ResidualProducts draw = noise.Draw(input.seed + 1, static_cast<uint64_t>(k));
    double largest = -std::numeric_limits<double>::infinity();
    for (const NamedEvidence& named :
         SumVariants(input.baseline, beside_nothing.LogBayesFactors(draw.toward)))
      if (named.kind == HypothesisKind::kEffect) largest = std::max(largest, named.evidence);
    best.push_back(largest);
  }
  std::sort(best.begin(), best.end());
  const double chance = best[static_cast<size_t>(0.95 * kDraws)];
  return std::isfinite(chance) ? chance : std::numeric_limits<double>::quiet_NaN();
}

// `removed`: twice the evidence of the hypothesis and of the effects added before, i.e. the misfit
// that they have removed, as AdequacyTest::left counts what is left.
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
  adequacy.left_share =
      removed > 0 ? std::max(0.0, test.left) / removed : std::numeric_limits<double>::infinity();
  adequacy.is_tolerated = adequacy.left_share < kToleratedModelError;
  return adequacy;
}

bool IsEnough(const RecordedAdequacy& adequacy) {
  return adequacy.is_adequate || adequacy.is_tolerated;
}

// Tests a hypothesis of the posterior, with the nuisances that explain what it leaves.
RecordedAdequacy AdequacyOf(const DecisionInput& input, const Weighed& weighed,
                            const HypothesisProbability& hypothesis) {
  const HypothesisProbability& part = weighed.PartOf(hypothesis);
  TestedSpace tested = weighed.Tested(input, part);
  std::vector<std::string> beside = hypothesis.names.empty() ? input.adopted : hypothesis.names;
  if (part.kind == Kind::kEffect || part.kind == Kind::kPair)
    for (const std::string& nuisance : TakeNuisancesBeside(&tested))
      if (std::count(beside.begin(), beside.end(), nuisance) == 0) beside.push_back(nuisance);
  const AdequacyTest test =
      TestAdequacy(*tested.space, tested.columns, input.noise_is_known, input.seed);
  return RecordOf(test, 2 * part.evidence + input.explained_misfit, std::move(beside));
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
    one.evidence -= model_error;
    if (one.kind == Kind::kEffect) one.family = FamilyOf(families, named.name);
  }
  return hypotheses;
}

std::vector<HypothesisProbability> PosteriorOf(const DecisionInput& input) {
  return Weighed(input).posterior;
}

Decision Decide(const DecisionInput& input) {
  const Weighed weighed(input);
  Decision decision;
  DecisionRecord& record = decision.record;
  record.probabilities = weighed.posterior;
  const Naming naming = NameFrom(record.probabilities);
  decision.names = naming.names;
  record.adequacy = AdequacyOf(input, weighed, record.probabilities.front());
  // Nothing unknown is left if any of the hypotheses that are kept explains everything.
  for (size_t k = 1; k < naming.kept.size() && !IsEnough(record.adequacy); ++k) {
    const HypothesisProbability& next = record.probabilities[naming.kept[k]];
    if (RecordedAdequacy other = AdequacyOf(input, weighed, next); IsEnough(other))
      record.adequacy = std::move(other);
  }
  record.chance = ChanceOf(input, weighed.beside_nothing);
  const bool is_measurement = std::all_of(naming.kept.begin(), naming.kept.end(), [&](size_t k) {
    return record.probabilities[k].kind == Kind::kNuisance;
  });
  if (!IsEnough(record.adequacy)) {
    decision.verdict = Verdict::kNotInLibrary;
  } else if (naming.level == Naming::Level::kNothing) {
    decision.verdict = input.is_anything_detectable ? Verdict::kAdequate : Verdict::kNoPower;
  } else if (is_measurement) {
    decision.verdict = Verdict::kNuisance;
  } else if (naming.level == Naming::Level::kCommon) {
    decision.verdict = Verdict::kMissing;
  } else {
    decision.verdict = Verdict::kAmbiguous;
  }
  return decision;
}

}  // namespace lacuna
