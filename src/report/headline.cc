#include "report/headline.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include "record/effect_card.h"
#include "record/ledger.h"
#include "report/agreement_text.h"
#include "report/calibration_report.h"
#include "report/missed_reaction.h"
#include "report/quantity_text.h"
#include "report/verdict_text.h"

namespace lacuna {
namespace {

// A statement that is at least this probable is more likely true than not.
constexpr double kLikely = 0.5;
// A fall of the error that is not rounded to 0 %.
constexpr double kSmallestFall = 0.005;

// "0.870 mm, 5.1 times the noise".
std::string ErrorInWords(const ModelErrors& errors) {
  return fmt::format("{}, {:.1f} times the noise", Millimetres(errors.held_out_rms),
                     errors.rms_over_sigma);
}

// What the recordings show: "markers", "scans" or both.
std::string ObservedKinds(const CalibrationRecord& record) {
  bool markers = false, scans = false;
  for (const FittedRecording& recording : record.recordings)
    (recording.scan ? scans : markers) = true;
  return markers && scans ? "markers and scans" : scans ? "scans" : "markers";
}

// The compared part with the largest error: held-out frames, or fitted ones where nothing was held
// out.
struct WorstPart {
  const ComparedRecording* recording = nullptr;
  const ComparedPart* part = nullptr;
};
WorstPart FindWorst(const ComparisonRecord& comparison, bool held_out) {
  WorstPart worst;
  for (const ComparedRecording& recording : comparison.recordings)
    for (const ComparedPart& part : recording.parts)
      if (part.fitted != held_out && part.worst_point >= 0 &&
          (worst.part == nullptr || part.error.rms > worst.part->error.rms))
        worst = {&recording, &part};
  return worst;
}

// "recording 1", or "recording fast" of one that is called "fast".
std::string RecordingLabel(const ComparedRecording& recording) {
  return (recording.name.starts_with("recording") ? "" : "recording ") + recording.name;
}

// Where and when the error is largest, after a semicolon; empty where it was not compared.
std::string WhereAndWhen(const ReportedModel& model) {
  if (!model.comparison || model.errors.rms_over_sigma < kBeyondNoise) return "";
  const WorstPart worst = FindWorst(*model.comparison, model.errors.has_held_out);
  if (worst.part == nullptr) return "";
  const auto point = static_cast<size_t>(worst.part->worst_point);
  std::string text =
      fmt::format("; the error is largest at {} {}", worst.recording->is_scan ? "patch" : "marker",
                  point < worst.recording->point_names.size() ? worst.recording->point_names[point]
                                                              : std::to_string(point));
  if (const auto& period = worst.part->worst_period)
    text += fmt::format(" and from {:.3g} s to {:.3g} s", period->from, period->to);
  if (model.comparison->recordings.size() > 1) text += " of " + RecordingLabel(*worst.recording);
  return text;
}

std::string FirstErrorSentence(const ReportedModel& model) {
  const bool misses = model.errors.rms_over_sigma >= kBeyondNoise;
  return fmt::format("The model {} the {} {} {} in frames that it was {}fitted to{}.",
                     misses ? "misses" : "meets", ObservedKinds(model.calibration),
                     misses ? "by" : "to within", ErrorInWords(model.errors) + ",",
                     model.errors.has_held_out ? "not " : "", WhereAndWhen(model));
}

// The number of standard deviations of its prior by which an estimate is off; 0 where a conflict
// has no such number.
struct DeviationsFromPrior {
  double operator()(const NuisanceParameterConflict& conflict) const { return conflict.deviations; }
  // The files do not contain a default prior, about which DefaultPriorSentence() speaks.
  double operator()(const ModelParameterConflict& conflict) const {
    return conflict.is_default ? 0 : conflict.deviations;
  }
  double operator()(const MarkerConflict& conflict) const {
    return conflict.offset.norm() / conflict.deviation;
  }
  double operator()(const ReferenceShapeConflict& conflict) const {
    return conflict.rms / conflict.deviation;
  }
  double operator()(const PatchConflict& conflict) const {
    return conflict.largest / conflict.deviation;
  }
  double operator()(const MarkerConflictCount&) const { return 0; }
  double operator()(const UnmatchedScans&) const { return 0; }
};

// The worst conflict with what the files say, where it is so large that the files are probably
// wrong. Empty where there is none.
std::string PriorConflictSentence(const CalibrationRecord& record) {
  constexpr double kProbablyWrong = 10;  // standard deviations
  const PriorConflict* worst = nullptr;
  double most = kProbablyWrong;
  for (const PriorConflict& conflict : record.prior_conflicts) {
    const double deviations = std::visit(DeviationsFromPrior{}, conflict);
    if (!(deviations > most)) continue;
    most = deviations;
    worst = &conflict;
  }
  if (worst == nullptr) return "";
  return fmt::format(
      "The fit contradicts what the files say by {:.0f} standard deviations, which should be "
      "checked first: {}.",
      most, DescribePriorConflict(*worst));
}

// The parameter that a default prior holds back most; empty where there is none. The value and its
// interval are wrong without any other sign if the prior is.
std::string DefaultPriorSentence(const CalibrationRecord& record) {
  const ModelParameterConflict* worst = nullptr;
  for (const PriorConflict& conflict : record.prior_conflicts) {
    const auto* of_model = std::get_if<ModelParameterConflict>(&conflict);
    if (of_model == nullptr || !of_model->is_default) continue;
    if (worst == nullptr || of_model->deviations > worst->deviations) worst = of_model;
  }
  if (worst == nullptr) return "";
  return fmt::format("A default prior may distort the fit: {}.", DescribePriorConflict(*worst));
}

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

// With the probability that this effect or nuisance is the cause, whatever nuisances stand beside
// it, but no further effect.
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

std::string NuisanceSentence(const ReportedModel& model) {
  const DiagnosisRecord& diagnosis = *model.diagnosis;
  std::vector<std::string> whats;
  for (const std::string& name : diagnosis.effects) whats.push_back(TitleOf(diagnosis, name));
  std::string advice;
  for (const RecordedNuisance& nuisance : diagnosis.nuisances)
    if (!diagnosis.effects.empty() && nuisance.name == diagnosis.effects.front() &&
        !nuisance.advice.empty() && advice.empty())
      advice = " What to do: " + nuisance.advice + ".";
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

// Where nothing more is missing in the recordings that were fitted, but others are not met: those.
// Empty where there are none, and without a diagnosis.
std::string NotMetElsewhere(const ReportedModel& model) {
  if (!model.diagnosis) return "";
  const Verdict verdict = model.diagnosis->verdict;
  if (verdict != Verdict::kNuisance && verdict != Verdict::kAdequate) return "";
  std::vector<std::string> missed;
  for (const FittedRecording& recording : model.calibration.recordings) {
    if (recording.fitted) continue;
    if (recording.held_out.points == 0)
      missed.push_back(recording.name + " (it could not be simulated)");
    else if (recording.held_out.rms_over_sigma >= kBeyondNoise)
      missed.push_back(fmt::format("{} ({:.1f} times the noise)", recording.name,
                                   recording.held_out.rms_over_sigma));
  }
  if (missed.empty()) return "";
  return fmt::format(
      "That holds for the recordings that were fitted. Of the others, the model does not meet "
      "these to within the noise: {}. To have them diagnosed, set `fitted: true` in a copy of the "
      "experiment.",
      fmt::join(missed, ", "));
}

// Which of the added effects may be zero in the last model.
void AddDispensable(const std::vector<ReportedModel>& models, std::vector<std::string>* sentences) {
  for (size_t k = 1; k + 1 < models.size(); ++k)
    if (const auto& diagnosis = models[k - 1].diagnosis;
        diagnosis && SizeMayBeZero(models.back().calibration, *diagnosis, models[k].added))
      sentences->push_back(
          fmt::format("Beside what was added later, {} may be zero: it may be left out.",
                      ShortTitle(*diagnosis, models[k].added)));
}

std::string AfterAdding(const ReportedModel& model, const ReportedModel& before) {
  const std::string title =
      before.diagnosis ? ShortTitle(*before.diagnosis, model.added) : model.added;
  if (!model.calibration.usable)
    return fmt::format("The model with {} could not be fitted: {}.", title,
                       model.calibration.message);
  const double fall = 1 - model.errors.held_out_rms / before.errors.held_out_rms;
  if (!(fall >= kSmallestFall)) {
    const std::string stays =
        fmt::format("With {}, the error is {}", title, ErrorInWords(model.errors));
    const double at_measured_places = model.errors.held_out_at_measured_places;
    const double before_there = before.errors.held_out_at_measured_places;
    if (!(1 - at_measured_places / before_there >= kSmallestFall)) return stays + ".";
    return stays +
           fmt::format(
               ", but with the points at the places where they were measured, it falls from "
               "{:.3f} mm to {:.3f} mm: without {}, displaced places hide a part of the "
               "error.",
               1e3 * before_there, 1e3 * at_measured_places, title);
  }
  return fmt::format("With {}, the error falls by {:.0f} % to {}.", title, 100 * fall,
                     ErrorInWords(model.errors));
}

// Whether a diagnosis names this effect, and no other, as what is missing.
bool NamesOnly(const DiagnosisRecord& diagnosis, const std::string& effect) {
  return diagnosis.verdict == Verdict::kMissing &&
         diagnosis.effects == std::vector<std::string>{effect};
}

// What else is wrong with the fit, the verdict on the model and, where nothing more is missing in
// the fitted recordings, which others it does not meet.
void AddVerdict(const ReportedModel& model, std::vector<std::string>* sentences) {
  if (!model.calibration.usable) return;
  for (std::string sentence :
       {MissedReactionSentence(model), PriorConflictSentence(model.calibration),
        DefaultPriorSentence(model.calibration), VerdictSentence(model), NotMetElsewhere(model)})
    if (!sentence.empty()) sentences->push_back(std::move(sentence));
}

}  // namespace

std::vector<std::string> Headline(const std::vector<ReportedModel>& models) {
  CHECK(!models.empty());
  const ReportedModel& first = models.front();
  if (!first.calibration.usable)
    return {fmt::format("The fit did not succeed: {}.", first.calibration.message)};
  std::vector<std::string> sentences{FirstErrorSentence(first)};
  for (size_t k = 0; k < models.size(); ++k) {
    if (k > 0) sentences.push_back(AfterAdding(models[k], models[k - 1]));
    if (k + 1 == models.size()) {
      AddVerdict(models[k], &sentences);
      AddDispensable(models, &sentences);
      break;
    }
    // Without a diagnosis, what was added shows by itself that the model before lacked it.
    if (!models[k].diagnosis) continue;
    const DiagnosisRecord& diagnosis = *models[k].diagnosis;
    const std::string& added = models[k + 1].added;
    if (!SizeMayBeZero(models[k + 1].calibration, diagnosis, added)) {
      if (models[k].calibration.usable) sentences.push_back(VerdictSentence(models[k]));
      continue;
    }
    if (NamesOnly(diagnosis, added)) {
      sentences.push_back(fmt::format(
          "{} diagnosis names {}, but once it is fitted, its size may be zero, so that it does not "
          "count.",
          k > 0 ? "A further" : "The", WithProbability(diagnosis, added)));
    } else {
      AddVerdict(models[k], &sentences);
      sentences.push_back(fmt::format(
          "A model with {} was fitted, too, but its size may be zero, so that it does not count.",
          ShortTitle(diagnosis, added)));
    }
    break;
  }
  const auto last = std::find_if(models.rbegin(), models.rend(), [](const ReportedModel& model) {
    return model.diagnosis.has_value();
  });
  if (last != models.rend() && last->diagnosis->agreement.Disagree())
    sentences.push_back(ExplainAgreement(last->diagnosis->agreement));
  return sentences;
}

}  // namespace lacuna
