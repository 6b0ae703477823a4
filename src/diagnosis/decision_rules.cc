#include "diagnosis/decision_rules.h"

#include <algorithm>
#include <cmath>
#include <limits>

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
  const auto is_nuisance = [&](const std::string& name) { return IsNuisance(posterior, name); };
  for (const std::string& name : best.names)
    if (holds([&](const auto& one) { return one.Contains(name); })) naming.names.push_back(name);
  // Rival effects that only share the nuisances of every model have nothing in common.
  const bool share_nuisances = holds([](const auto& one) { return one.kind != Kind::kNuisance; }) &&
                               std::all_of(naming.names.begin(), naming.names.end(), is_nuisance);
  if (!naming.names.empty() && !share_nuisances) {
    naming.level = Naming::Level::kCommon;
    return naming;
  }
  naming.names.clear();
  for (const size_t k : naming.kept)
    for (const std::string& name : posterior[k].names)
      if (std::count(naming.names.begin(), naming.names.end(), name) == 0 &&
          (posterior[k].kind == Kind::kNuisance || !is_nuisance(name)))
        naming.names.push_back(name);
  const bool is_family = best.kind == Kind::kEffect && best.family != EffectFamily::kOther &&
                         holds([&](const auto& one) {
                           return one.kind == Kind::kEffect && one.family == best.family;
                         });
  naming.level = is_family ? Naming::Level::kFamily : Naming::Level::kSet;
  return naming;
}

}  // namespace lacuna
