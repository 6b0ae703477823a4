#include "trials/trial_rates.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

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

// How the names of a verdict "missing" compare with the effect that is hidden. All false for other
// verdicts.
struct ComparedNames {
  bool is_stated = false;
  bool is_other = false;    // another effect is among them ...
  bool is_outside = false;  // ... of another family

  ComparedNames(const TrialOutcome& outcome, const std::string& truth) {
    is_stated = outcome.verdict == Verdict::kMissing;
    if (!is_stated) return;
    for (const std::string& name : outcome.named) {
      is_other = is_other || name != truth;
      is_outside = is_outside || !IsMember(name, truth);
    }
  }
};

void Add(bool counts, Rate* rate) {
  ++rate->whole;
  rate->part += counts;
}

// Adds the frequency with which the simulated rules do what is counted.
void AddSimulated(double frequency, Rate* rate) {
  ++rate->simulated_cases;
  rate->simulated += frequency;
}

void CountOneEffect(const FinishedTrial& finished, TrialRates* rates) {
  const std::string& truth = finished.trial.hidden.front().type;
  const TrialOutcome& outcome = finished.outcome;
  const ComparedNames naming(outcome, truth);
  const bool is_right = naming.is_stated && !naming.is_other;
  Add(is_right, &rates->named);
  Add(naming.is_other && !naming.is_outside, &rates->wrong_member);
  Add(naming.is_outside, &rates->outside_family);
  if (naming.is_stated || outcome.verdict == Verdict::kAmbiguous)
    Add(std::any_of(outcome.named.begin(), outcome.named.end(),
                    [&](const std::string& name) { return IsMember(name, truth); }),
        &rates->family);
  if (!outcome.simulated) return;
  AddSimulated(outcome.simulated->named, &rates->named);
  AddSimulated(outcome.simulated->wrong_member, &rates->wrong_member);
  if (outcome.simulated->named >= kDecidable) Add(is_right, &rates->decidable_named);
}

void CountRemoved(const FinishedTrial& finished, TrialRates* rates) {
  const TrialOutcome& outcome = finished.outcome;
  const ComparedNames naming(outcome, finished.trial.hidden.front().type);
  const bool is_unknown = outcome.verdict == Verdict::kNotInLibrary;
  Add(naming.is_stated && !naming.is_outside, &rates->removed_member);
  Add(naming.is_outside, &rates->removed_outside);
  Add(is_unknown, &rates->not_in_library);
  if (!outcome.simulated) return;
  AddSimulated(outcome.simulated->wrong_member, &rates->removed_member);
  AddSimulated(outcome.simulated->unknown, &rates->not_in_library);
  if (outcome.simulated->unknown >= kDecidable) Add(is_unknown, &rates->decidable_not_in_library);
}

// A statement about effects is right if they are, whatever nuisances stand beside them.
void CountReliability(const FinishedTrial& finished, TrialRates* rates) {
  std::vector<std::string> truth = TruthOf(finished.trial);
  std::sort(truth.begin(), truth.end());
  std::map<std::vector<std::string>, double> statements;
  for (const HypothesisProbability& one : finished.outcome.probabilities) {
    std::vector<std::string> names = one.names;
    if (one.kind == HypothesisProbability::Kind::kEffect ||
        one.kind == HypothesisProbability::Kind::kPair)
      std::erase_if(names, [](const std::string& name) { return FindEntry(name) == nullptr; });
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());  // one effect twice
    statements[names] += one.probability;
  }
  for (const auto& [names, probability] : statements)
    for (ReliabilityBin& bin : rates->reliability) {
      if (probability < bin.low || (probability >= bin.high && bin.high < 1)) continue;
      ++bin.statements;
      bin.stated += probability;
      bin.right += names == truth;
    }
}

// One line of the report.
struct RateLine {
  const char* truth;
  std::string what;
  Rate rate;
};

std::vector<RateLine> LinesOf(const TrialRates& rates) {
  const char *nothing = "nothing is missing", *one = "one effect is missing",
             *removed = "one effect is missing and is not in the catalogue";
  const std::string decidable = fmt::format("at least {:.0f} %", 100 * kDecidable);
  return {
      {nothing, "an effect is named", rates.named_in_controls},
      {nothing, "an effect is named, the measurement has a fault", rates.named_in_hard_controls},
      {one, "it is named, and no other", rates.named},
      {one, "... where the simulated rules name it in " + decidable, rates.decidable_named},
      {one, "of verdicts with names: one is of its family", rates.family},
      {one, "another one of its family is named", rates.wrong_member},
      {one, "one of another family is named", rates.outside_family},
      {removed, "one of its family is named", rates.removed_member},
      {removed, "one of another family is named", rates.removed_outside},
      {removed, "not in library", rates.not_in_library},
      {removed, "... where the simulated rules say so in " + decidable,
       rates.decidable_not_in_library}};
}

}  // namespace

TrialRates RatesOf(const std::vector<FinishedTrial>& finished) {
  TrialRates rates;
  for (const FinishedTrial& one : finished) {
    const TrialGroup group = one.trial.group;
    const bool is_stated = one.outcome.verdict == Verdict::kMissing;
    if (group == TrialGroup::kControl) Add(is_stated, &rates.named_in_controls);
    if (group == TrialGroup::kHardControl) Add(is_stated, &rates.named_in_hard_controls);
    if (group == TrialGroup::kOneEffect) CountOneEffect(one, &rates);
    if (group == TrialGroup::kRemoved)
      CountRemoved(one, &rates);
    else if (one.outcome.verdict != Verdict::kNotInLibrary)
      CountReliability(one, &rates);
  }
  return rates;
}

std::string RatesInWords(const TrialRates& rates) {
  std::string text, truth;
  for (const RateLine& line : LinesOf(rates)) {
    if (line.truth != truth) text += fmt::format("{}\n", line.truth);
    truth = line.truth;
    text += fmt::format("  {:54}", line.what);
    const Rate& rate = line.rate;
    if (rate.whole == 0)
      text += " no such case";
    else
      text += fmt::format(" {:3} of {:3} ({:.0f} %)", rate.part, rate.whole,
                          100.0 * rate.part / rate.whole);
    if (rate.simulated_cases > 0)
      text += fmt::format("; the simulated rules: {:.0f} % on average over {} cases",
                          100 * rate.simulated / rate.simulated_cases, rate.simulated_cases);
    text += "\n";
  }
  text += "probabilities of statements, and how many were true\n";
  for (const ReliabilityBin& bin : rates.reliability)
    if (bin.statements > 0)
      text += fmt::format(
          "  {:54} stated {:.0f} %, true {:.0f} %\n",
          fmt::format("{:.2f} to {:.2f}: {} statements", bin.low, bin.high, bin.statements),
          100 * bin.stated / bin.statements, 100.0 * bin.right / bin.statements);
  return text;
}

nlohmann::json RatesToJson(const TrialRates& rates) {
  nlohmann::json lines = nlohmann::json::array(), calibration = nlohmann::json::array();
  for (const RateLine& line : LinesOf(rates)) {
    lines.push_back({{"truth", line.truth},
                     {"what", line.what},
                     {"cases", line.rate.part},
                     {"of", line.rate.whole},
                     {"predicted", nullptr}});
    if (line.rate.simulated_cases > 0)
      lines.back()["predicted"] = line.rate.simulated / line.rate.simulated_cases;
  }
  for (const ReliabilityBin& bin : rates.reliability)
    if (bin.statements > 0)
      calibration.push_back({{"low", bin.low},
                             {"high", bin.high},
                             {"statements", bin.statements},
                             {"stated", bin.stated / bin.statements},
                             {"frequency", 1.0 * bin.right / bin.statements}});
  return {{"rates", lines}, {"calibration", calibration}};
}

}  // namespace lacuna
