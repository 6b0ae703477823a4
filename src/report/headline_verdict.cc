#include "report/headline_verdict.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>
#include <vector>

#include "record/effect_card.h"
#include "report/quantity_text.h"
#include "report/verdict_text.h"

namespace lacuna {
namespace {

std::string NextStep(const DiagnosisRecord& diagnosis) {
  const std::string steps = DescribeNextSteps(diagnosis);
  return steps.empty() ? "" : " To decide: " + steps + (steps.ends_with('.') ? "" : ".");
}

// The sum over the hypotheses that fulfil a condition; NaN where the record has none.
template <class Condition>
double ProbabilityWhere(const DecisionRecord& decision, const Condition& condition) {
  double sum = kNotMeasured;
  for (const HypothesisProbability& one : decision.probabilities)
    if (condition(one)) sum = (std::isnan(sum) ? 0 : sum) + one.probability;
  return sum;
}

// The family of an effect; empty where no hypothesis has it alone or with nuisances beside it.
std::optional<EffectFamily> FamilyOf(const DecisionRecord& decision, const std::string& effect) {
  for (const HypothesisProbability& one : decision.probabilities)
    if (one.kind == HypothesisProbability::Kind::kEffect && one.names.front() == effect)
      return one.family;
  return std::nullopt;
}

std::string MissingSentence(const ReportedModel& model) {
  const DiagnosisRecord& diagnosis = *model.diagnosis;
  std::vector<std::string> titles, details;
  for (const std::string& name : diagnosis.effects) titles.push_back(ShortTitle(diagnosis, name));
  const std::optional<EffectFamily> family =
      diagnosis.effects.size() == 1 ? FamilyOf(diagnosis.decision, diagnosis.effects.front())
                                    : std::nullopt;
  if (family && *family != EffectFamily::kOther) details.push_back(FamilyTitle(*family));
  // Whatever else may be missing, too.
  const double probability =
      ProbabilityWhere(diagnosis.decision, [&](const HypothesisProbability& one) {
        return std::all_of(diagnosis.effects.begin(), diagnosis.effects.end(),
                           [&](const auto& name) { return one.Contains(name); });
      });
  if (!std::isnan(probability)) details.push_back("probability " + PercentText(probability));
  return fmt::format("What it {}lacks: {}{}.", model.added.empty() ? "" : "still ",
                     fmt::join(titles, " and "),
                     details.empty() ? "" : fmt::format(" ({})", fmt::join(details, "; ")));
}

std::string AmbiguousSentence(const ReportedModel& model) {
  const DiagnosisRecord& diagnosis = *model.diagnosis;
  std::vector<std::string> titles;
  for (const std::string& name : diagnosis.effects)
    titles.push_back(WithProbability(diagnosis, name));
  return fmt::format(
      "Something is missing, but these recordings cannot tell which of these: {}.{}{}",
      fmt::join(titles, ", or "), NextStep(diagnosis),
      HasPlannableRecording(model.calibration) ? " `lacuna plan` computes which recording would."
                                               : "");
}

// The nuisance of every model that explains more than all nuisances that the verdict names: with
// coarse elements, for instance, what is left of their error may look like a grip that reaches
// further. Null: there is none.
const RecordedNuisance* ExplainsMoreThanNamed(const DiagnosisRecord& diagnosis) {
  double named = 0;
  for (const RecordedNuisance& nuisance : diagnosis.nuisances)
    if (std::count(diagnosis.effects.begin(), diagnosis.effects.end(), nuisance.name) > 0)
      named = std::max(named, nuisance.explained);
  const RecordedNuisance* most = BestAdoptedNuisance(diagnosis);
  return most != nullptr && most->explained > named ? most : nullptr;
}

std::string NuisanceSentence(const ReportedModel& model) {
  const DiagnosisRecord& diagnosis = *model.diagnosis;
  std::vector<std::string> whats;
  for (const std::string& name : diagnosis.effects) whats.push_back(TitleOf(diagnosis, name));
  std::string advice;
  const RecordedNuisance* first =
      diagnosis.effects.empty() ? nullptr : StrongestNuisance(diagnosis, diagnosis.effects.front());
  if (first != nullptr && !first->advice.empty()) advice = " What to do: " + first->advice + ".";
  if (const RecordedNuisance* more = ExplainsMoreThanNamed(diagnosis))
    advice += fmt::format(
        " But first: {}. In the model as it is, {} explains more of the error, {:.0f} %, of which "
        "it may have left a part.",
        more->advice, TitleOf(diagnosis, more->name), 100 * more->explained);
  return fmt::format(
      "No {} effect needs to be missing: an error of the measurement or of the computation "
      "explains {}{}.{}",
      model.added.empty() ? "physical" : "further", model.added.empty() ? "it" : "what is left",
      whats.empty() ? "" : fmt::format(" ({})", fmt::join(whats, ", ")), advice);
}

// The probability of all hypotheses without an effect; NaN where the record has none.
double ProbabilityOfNoEffect(const DecisionRecord& decision) {
  using Kind = HypothesisProbability::Kind;
  return ProbabilityWhere(decision, [](const HypothesisProbability& one) {
    return one.kind == Kind::kNothing || one.kind == Kind::kNuisance;
  });
}

// Whether the model has an effect of this type, with fitted or with given parameters.
bool IsInModel(const ReportedModel& model, const std::string& type) {
  const auto is_of_type = [&](const auto& parameter) {
    return parameter.name.starts_with(type + ".") || parameter.name.starts_with(type + "#");
  };
  const CalibrationRecord& fit = model.calibration;
  return std::any_of(fit.parameters.begin(), fit.parameters.end(), is_of_type) ||
         std::any_of(fit.held.begin(), fit.held.end(), is_of_type);
}

// The effects that would have stayed hidden in the recordings at a considerable size, in a sentence
// of its own; empty where there are none. Hypotheses that are not tried to first order do not
// count.
std::string HiddenSentence(const ReportedModel& model) {
  const DiagnosisRecord& diagnosis = *model.diagnosis;
  constexpr double kConsiderable = 0.1;  // of the largest plausible size
  constexpr size_t kMostNames = 3;
  std::vector<std::string> hidden;
  for (const RecordedEffect& effect : diagnosis.ranking) {
    const bool is_hidden =
        !effect.sizes.empty() &&
        std::all_of(effect.sizes.begin(), effect.sizes.end(), [](const RecordedSize& size) {
          return size.detectable > kConsiderable * size.plausible;
        });
    if (is_hidden)
      hidden.push_back((IsInModel(model, effect.type) ? "another " : "") +
                       ShortTitle(diagnosis, effect.type));
  }
  if (hidden.empty()) return "";
  if (const size_t others = hidden.size() - std::min(hidden.size(), kMostNames); others > 0) {
    hidden.resize(kMostNames);
    hidden.push_back(fmt::format("{} other{}", others, others > 1 ? "s" : ""));
  }
  return fmt::format(
      " Not every further effect would have been noticed: {} could have a tenth of the largest "
      "plausible size.",
      EnumerationText(hidden));
}

std::string AdequateSentence(const ReportedModel& model) {
  const DiagnosisRecord& diagnosis = *model.diagnosis;
  const double nothing = ProbabilityOfNoEffect(diagnosis.decision);
  const std::string corrected = CorrectedError(diagnosis);
  return fmt::format(
      "{}{}: {}.{}",
      nothing < kLikely ? "No further effect can be named with certainty"
                        : "No further effect is needed",
      std::isnan(nothing)
          ? ""
          : fmt::format(" (probability that no effect is missing: {})", PercentText(nothing)),
      corrected.empty() ? "the error that is left is that of the noise, or no larger than the "
                          "error of any model"
                        : corrected,
      HiddenSentence(model));
}

std::string UnknownSentence(const DiagnosisRecord& diagnosis) {
  const std::optional<std::string> part = PartlyExplainedBy(diagnosis);
  if (!part) return "Something is missing that no effect of the catalogue explains.";
  const auto& remains = std::get<ResidualRemains>(diagnosis.reasons.front());
  std::vector<std::string> beside;
  for (const std::string& name : TestedBeside(diagnosis, *part))
    beside.push_back(ShortTitle(diagnosis, name));
  return fmt::format(
      "Of all effects of the catalogue, {} explains most: {:.0f} % of the squared error beyond the "
      "noise. {}{:.1f} times the noise is left, which no effect explains: something else is "
      "missing, beside it or in its place.",
      ShortTitle(diagnosis, *part), 100 * remains.share,
      beside.empty() ? "" : fmt::format("With {} beside it, ", EnumerationText(beside)),
      remains.rms_over_sigma);
}

// A wrong stiffness that no fit may correct looks like a missing effect. Empty where it was fitted.
std::string HeldModulusSentence(const ReportedModel& model) {
  for (const HeldParameter& held : model.calibration.held)
    if (held.name == "young_modulus")
      return fmt::format(
          " Young's modulus was not fitted: if {:.3g} {} is wrong, an effect may stand in for it.",
          held.values.front(), held.unit);
  return "";
}

}  // namespace

std::string WithProbability(const DiagnosisRecord& diagnosis, const std::string& name) {
  using Kind = HypothesisProbability::Kind;
  const double probability =
      ProbabilityWhere(diagnosis.decision, [&](const HypothesisProbability& one) {
        return (one.kind == Kind::kEffect || one.kind == Kind::kNuisance) &&
               one.names.front() == name;
      });
  return ShortTitle(diagnosis, name) +
         (std::isnan(probability) ? "" : fmt::format(" ({})", PercentText(probability)));
}

std::string VerdictSentence(const ReportedModel& model) {
  if (!model.diagnosis)
    return model.errors.rms_over_sigma < kBeyondNoise
               ? ""
               : "What is missing has not been diagnosed yet; `lacuna diagnose` does so.";
  const DiagnosisRecord& diagnosis = *model.diagnosis;
  switch (diagnosis.verdict) {
    case Verdict::kMissing:
      return MissingSentence(model) + HeldModulusSentence(model);
    case Verdict::kAmbiguous:
      return AmbiguousSentence(model) + HeldModulusSentence(model);
    case Verdict::kNuisance:
      return NuisanceSentence(model);
    case Verdict::kNotInLibrary:
      return UnknownSentence(diagnosis) + HeldModulusSentence(model);
    case Verdict::kNoPower:
      return "These recordings could not show any effect of plausible size, so that nothing can be "
             "said about what is missing: more motion, other loads or less noise are needed.";
    case Verdict::kAdequate:
      break;
  }
  return AdequateSentence(model);
}

}  // namespace lacuna
