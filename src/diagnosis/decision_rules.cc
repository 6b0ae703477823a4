#include "diagnosis/decision_rules.h"

#include <algorithm>
#include <cmath>

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
  const auto weight = [](const HypothesisProbability& one) {
    return one.evidence + LogPrior(one.kind);
  };
  double largest = -std::numeric_limits<double>::infinity(), sum = 0;
  for (const HypothesisProbability& one : *hypotheses) largest = std::max(largest, weight(one));
  for (HypothesisProbability& one : *hypotheses) {
    one.probability = std::exp(weight(one) - largest);
    sum += one.probability;
  }
  for (HypothesisProbability& one : *hypotheses) one.probability /= sum;
  std::stable_sort(hypotheses->begin(), hypotheses->end(),
                   [&](const auto& a, const auto& b) { return weight(a) > weight(b); });
}

Naming NameFrom(const std::vector<HypothesisProbability>& posterior) {
  Naming naming;
  double sum = 0;
  for (size_t k = 0; k < posterior.size() && sum < kNamingProbability; ++k) {
    naming.kept.push_back(k);
    sum += posterior[k].probability;
  }
  const HypothesisProbability& best = posterior.front();
  const auto holds = [&](const auto& condition) {
    return std::all_of(naming.kept.begin(), naming.kept.end(),
                       [&](size_t k) { return condition(posterior[k]); });
  };
  if (!holds([](const auto& one) { return one.kind != Kind::kNothing; }))
    naming.level = Naming::Level::kNothing;
  else if (naming.kept.size() == 1)
    naming.level = Naming::Level::kMember;
  else if (best.kind == Kind::kEffect && holds([&](const auto& one) {
             return one.kind == Kind::kEffect && one.family == best.family;
           }))
    naming.level = Naming::Level::kFamily;
  else
    naming.level = Naming::Level::kSet;
  return naming;
}

}  // namespace lacuna
