#include "trials/trial_rates.h"

#include <fmt/format.h>

#include <algorithm>

#include "diagnosis/nuisance_catalogue.h"
#include "effects/catalogue.h"

namespace lacuna {
namespace {

EffectFamily FamilyOfType(const std::string& type) {
  const CatalogueEntry* entry = FindEntry(type);
  return entry != nullptr ? entry->card->family : EffectFamily::kOther;
}

bool IsMember(const std::string& type, const std::string& of) {
  return type == of ||
         (FamilyOfType(of) != EffectFamily::kOther && FamilyOfType(type) == FamilyOfType(of));
}

// What the posterior should contain: the hidden effects, or the nuisance of a hard control unless
// every model has it.
std::vector<std::string> TruthOf(const TrialCase& trial) {
  std::vector<std::string> truth;
  for (const HiddenEffect& hidden : trial.hidden) truth.push_back(hidden.type);
  for (const NuisanceEntry& entry : NuisanceCatalogue())
    if (!trial.nuisance.empty() && entry.card.trial.control == trial.nuisance &&
        !entry.card.is_always_in_model)
      truth.push_back(entry.card.name);
  return truth;
}

void CountOneEffect(const FinishedTrial& finished, TrialRates* rates) {
  const std::string& truth = finished.trial.hidden.front().type;
  const TrialOutcome& outcome = finished.outcome;
  const bool is_stated = outcome.verdict == Verdict::kMissing;
  const auto any = [&](const auto& condition) {
    return std::any_of(outcome.named.begin(), outcome.named.end(), condition);
  };
  const bool is_outside =
      is_stated && any([&](const std::string& name) { return !IsMember(name, truth); });
  const bool is_other = is_stated && any([&](const std::string& name) { return name != truth; });
  const bool is_decidable = outcome.bound && outcome.bound->named >= kDecidable;
  ++rates->named.whole;
  rates->named.part += is_stated && !is_other;
  rates->decidable_named.whole += is_decidable;
  rates->decidable_named.part += is_decidable && is_stated && !is_other;
  ++rates->wrong_member.whole;
  rates->wrong_member.part += is_other && !is_outside;
  ++rates->outside_family.whole;
  rates->outside_family.part += is_outside;
  if (is_stated || outcome.verdict == Verdict::kAmbiguous) {
    ++rates->family.whole;
    rates->family.part += any([&](const std::string& name) { return IsMember(name, truth); });
  }
  if (!outcome.bound) return;
  ++rates->bounded;
  rates->bound_named += outcome.bound->named;
}

void CountRemoved(const FinishedTrial& finished, TrialRates* rates) {
  const std::string& truth = finished.trial.hidden.front().type;
  const TrialOutcome& outcome = finished.outcome;
  const bool is_stated = outcome.verdict == Verdict::kMissing;
  const bool is_outside =
      is_stated && std::any_of(outcome.named.begin(), outcome.named.end(),
                               [&](const std::string& name) { return !IsMember(name, truth); });
  ++rates->removed_member.whole;
  rates->removed_member.part += is_stated && !is_outside;
  ++rates->removed_outside.whole;
  rates->removed_outside.part += is_outside;
  if (!outcome.bound) return;
  ++rates->removed_bounded;
  rates->bound_unknown += outcome.bound->unknown;
  if (outcome.bound->unknown < kDecidable) return;
  ++rates->unknown.whole;
  rates->unknown.part += outcome.verdict == Verdict::kNotInLibrary;
}

// A hypothesis about effects is right if they are, whatever nuisances it contains.
void CountReliability(const FinishedTrial& finished, TrialRates* rates) {
  std::vector<std::string> truth = TruthOf(finished.trial);
  std::sort(truth.begin(), truth.end());
  for (const HypothesisProbability& one : finished.outcome.probabilities) {
    std::vector<std::string> names = one.names;
    if (one.kind == HypothesisProbability::Kind::kEffect ||
        one.kind == HypothesisProbability::Kind::kPair)
      std::erase_if(names, [](const std::string& name) { return FindEntry(name) == nullptr; });
    std::sort(names.begin(), names.end());
    for (ReliabilityBin& bin : rates->reliability) {
      if (one.probability < bin.low || (one.probability >= bin.high && bin.high < 1)) continue;
      ++bin.hypotheses;
      bin.stated += one.probability;
      bin.right += names == truth;
    }
  }
}

std::string Described(const Rate& rate) {
  if (rate.whole == 0) return "no such case";
  return fmt::format("{} of {} ({:.0f} %)", rate.part, rate.whole, 100.0 * rate.part / rate.whole);
}

std::string Bound(double sum, int cases) {
  if (cases == 0) return "";
  return fmt::format("; the simulated rules: {:.0f} % of {} cases", 100 * sum / cases, cases);
}

}  // namespace

TrialRates RatesOf(const std::vector<FinishedTrial>& finished) {
  TrialRates rates;
  for (const FinishedTrial& one : finished) {
    const std::string& group = one.trial.group;
    const bool is_stated = one.outcome.verdict == Verdict::kMissing;
    if (group == "control" || group == "hard_control") {
      Rate& rate = group == "control" ? rates.named_in_controls : rates.named_in_hard_controls;
      ++rate.whole;
      rate.part += is_stated;
    }
    if (group == "one_effect") CountOneEffect(one, &rates);
    if (group == "removed")
      CountRemoved(one, &rates);
    else if (one.outcome.verdict != Verdict::kNotInLibrary)
      CountReliability(one, &rates);
  }
  return rates;
}

std::string RatesInWords(const TrialRates& rates) {
  std::string text;
  const auto line = [&](const std::string& what, const std::string& value) {
    text += fmt::format("  {:58} {}\n", what, value);
  };
  text += "nothing is missing\n";
  line("an effect is named", Described(rates.named_in_controls));
  line("an effect is named, the measurement has a fault", Described(rates.named_in_hard_controls));
  text += "one effect is missing\n";
  line("it is named, and no other",
       Described(rates.named) + Bound(rates.bound_named, rates.bounded));
  line(fmt::format("... where the simulated rules name it in {:.0f} %", 100 * kDecidable),
       Described(rates.decidable_named));
  line("of verdicts with names: one is of its family", Described(rates.family));
  line("another one of its family is named", Described(rates.wrong_member));
  line("one of another family is named", Described(rates.outside_family));
  text += "one effect is missing and is not in the catalogue\n";
  line("one of its family is named", Described(rates.removed_member));
  line("one of another family is named", Described(rates.removed_outside));
  line(
      fmt::format("not in library, where the simulated rules say so in {:.0f} %", 100 * kDecidable),
      Described(rates.unknown) + Bound(rates.bound_unknown, rates.removed_bounded));
  text += "stated probabilities of hypotheses, and how many were true\n";
  for (const ReliabilityBin& bin : rates.reliability) {
    if (bin.hypotheses == 0) continue;
    line(fmt::format("{:.2f} to {:.2f}: {} hypotheses", bin.low, bin.high, bin.hypotheses),
         fmt::format("stated {:.0f} %, true {:.0f} %", 100 * bin.stated / bin.hypotheses,
                     100.0 * bin.right / bin.hypotheses));
  }
  return text;
}

}  // namespace lacuna
