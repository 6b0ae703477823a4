#include "report/headline.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "record/ledger.h"
#include "report/agreement_text.h"
#include "report/calibration_report.h"
#include "report/headline_verdict.h"
#include "report/missed_reaction.h"
#include "report/quantity_text.h"
#include "report/verdict_text.h"

namespace lacuna {
namespace {

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
