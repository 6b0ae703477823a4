#include "diagnosis/decision_rules.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace lacuna {
namespace {

using Kind = HypothesisProbability::Kind;

double LogPrior(Kind kind) {
  switch (kind) {
    case Kind::kNothing:
      return std::log(kPriorNothing);
    case Kind::kEffect:
      return std::log(kPriorEffects);
    case Kind::kNuisance:
      return std::log(kPriorNuisances);
    case Kind::kPair:
      return std::log(kPriorPairs);
  }
  return 0;
}

// What a hypothesis says is missing, every name once: its effects or, where it has none, its
// nuisances. Rivals that only share the nuisances beside an effect have nothing in common.
std::vector<std::string> WithoutNuisancesBeside(const std::vector<HypothesisProbability>& posterior,
                                                const HypothesisProbability& one) {
  std::vector<std::string> names;
  for (const std::string& name : one.names)
    if ((one.kind == Kind::kNuisance || !IsNuisance(posterior, name)) &&
        std::count(names.begin(), names.end(), name) == 0)
      names.push_back(name);
  return names;
}

}  // namespace

void SetPosterior(std::vector<HypothesisProbability>* hypotheses) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto weight = [](const HypothesisProbability& one) {
    return one.is_refuted ? -kInfinity : one.evidence + LogPrior(one.kind);
  };
  double largest = -kInfinity, sum = 0;
  for (const HypothesisProbability& one : *hypotheses) largest = std::max(largest, weight(one));
  for (HypothesisProbability& one : *hypotheses) {
    one.probability = std::exp(weight(one) - largest);
    sum += one.probability;
  }
  for (HypothesisProbability& one : *hypotheses) one.probability /= sum;
  std::stable_sort(hypotheses->begin(), hypotheses->end(),
                   [&](const auto& a, const auto& b) { return weight(a) > weight(b); });
}

bool IsRepeated(const HypothesisProbability& a, const HypothesisProbability& b) {
  const auto contains_all = [](const HypothesisProbability& one, const auto& names) {
    return std::all_of(names.begin(), names.end(),
                       [&](const std::string& name) { return one.Contains(name); });
  };
  return a.kind == b.kind && contains_all(a, b.names) && contains_all(b, a.names);
}

void MergeRepeated(std::vector<HypothesisProbability>* posterior) {
  std::vector<HypothesisProbability> merged;
  for (HypothesisProbability& one : *posterior) {
    const auto same = std::find_if(merged.begin(), merged.end(),
                                   [&](const auto& other) { return IsRepeated(one, other); });
    if (same == merged.end()) {
      // The two effects of a pair may be one effect twice.
      const size_t effects = one.kind == Kind::kPair ? 2 : 0;
      std::vector<std::string> names(one.names.begin(), one.names.begin() + effects);
      for (size_t k = effects; k < one.names.size(); ++k)
        if (std::count(names.begin(), names.end(), one.names[k]) == 0)
          names.push_back(one.names[k]);
      one.names = std::move(names);
      merged.push_back(std::move(one));
    } else if (one.probability > 0) {
      // Hypotheses of one kind have one prior, so that their Bayes factors add up likewise.
      same->evidence += std::log1p(one.probability / same->probability);
      same->probability += one.probability;
    }
  }
  std::stable_sort(merged.begin(), merged.end(),
                   [](const auto& a, const auto& b) { return a.probability > b.probability; });
  *posterior = std::move(merged);
}

bool IsNuisance(const std::vector<HypothesisProbability>& posterior, const std::string& name) {
  return std::any_of(posterior.begin(), posterior.end(), [&](const HypothesisProbability& one) {
    return one.kind == Kind::kNuisance && one.Contains(name);
  });
}

Naming NameFrom(const std::vector<HypothesisProbability>& posterior) {
  Naming naming;
  double sum = 0;
  for (size_t k = 0; k < posterior.size() && sum < kStatedProbability; ++k) {
    naming.kept.push_back(k);
    sum += posterior[k].probability;
  }
  const auto holds = [&](const auto& condition) {
    return std::all_of(naming.kept.begin(), naming.kept.end(),
                       [&](size_t k) { return condition(posterior[k]); });
  };
  if (!holds([](const auto& one) { return one.kind != Kind::kNothing; })) return naming;
  const HypothesisProbability& best = posterior.front();
  const std::vector<std::string> named = WithoutNuisancesBeside(posterior, best);
  std::copy_if(named.begin(), named.end(), std::back_inserter(naming.names),
               [&](const std::string& name) {
                 return holds([&](const auto& one) {
                   const std::vector<std::string> other = WithoutNuisancesBeside(posterior, one);
                   return std::count(other.begin(), other.end(), name) > 0;
                 });
               });
  if (!naming.names.empty()) {
    naming.level = Naming::Level::kCommon;
    return naming;
  }
  for (const size_t k : naming.kept)
    for (const std::string& name : WithoutNuisancesBeside(posterior, posterior[k]))
      if (std::count(naming.names.begin(), naming.names.end(), name) == 0)
        naming.names.push_back(name);
  const bool is_family = best.kind == Kind::kEffect && best.family != EffectFamily::kOther &&
                         holds([&](const auto& one) {
                           return one.kind == Kind::kEffect && one.family == best.family;
                         });
  naming.level = is_family ? Naming::Level::kFamily : Naming::Level::kSet;
  return naming;
}

}  // namespace lacuna
