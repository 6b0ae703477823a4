#include "plan/rivals.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "diagnosis/decision_rules.h"
#include "report/verdict_text.h"

namespace lacuna {
namespace {

using Kind = HypothesisProbability::Kind;

}  // namespace

bool IsOfEffects(const HypothesisProbability& one) {
  return one.kind == Kind::kEffect || one.kind == Kind::kPair;
}

std::vector<std::string> EffectsOf(const std::vector<HypothesisProbability>& all,
                                   const HypothesisProbability& one) {
  if (one.kind != Kind::kPair) return {one.names.front()};
  std::vector<std::string> effects = one.names;
  std::erase_if(effects, [&](const std::string& name) { return IsNuisance(all, name); });
  std::sort(effects.begin(), effects.end());
  return effects;
}

std::string RivalName(const std::vector<std::string>& effects) {
  return fmt::format("{}", fmt::join(effects, " with "));
}

std::vector<PlannedRival> RivalsOf(const DiagnosisRecord& diagnosis) {
  const std::vector<HypothesisProbability>& all = diagnosis.decision.probabilities;
  std::vector<PlannedRival> rivals;
  for (const size_t k : NameFrom(all).kept) {
    if (!IsOfEffects(all[k])) continue;
    std::vector<std::string> effects = EffectsOf(all, all[k]);
    const std::string name = RivalName(effects);
    const auto known = std::find_if(rivals.begin(), rivals.end(), [&](const PlannedRival& rival) {
      return rival.effect == name;
    });
    if (known != rivals.end()) {
      known->probability += all[k].probability;
      continue;
    }
    std::string title = ShortTitle(diagnosis, effects.front());
    if (effects.size() == 2)
      title += effects.front() == effects.back()
                   ? ", twice"
                   : " together with " + ShortTitle(diagnosis, effects.back());
    rivals.push_back({name, title, all[k].probability, 0, std::move(effects)});
  }
  std::stable_sort(rivals.begin(), rivals.end(), [](const PlannedRival& a, const PlannedRival& b) {
    return a.probability > b.probability;
  });
  return rivals;
}

}  // namespace lacuna
