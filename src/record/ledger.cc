#include "record/ledger.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/json_number.h"

namespace lacuna {
namespace {

using nlohmann::json;

constexpr int kSchemaVersion = 3;

const char* ReasonName(LedgerEnding::Reason reason) {
  switch (reason) {
    case LedgerEnding::Reason::kVerdict:
      return "verdict";
    case LedgerEnding::Reason::kUndecided:
      return "undecided";
    case LedgerEnding::Reason::kMostEffects:
      return "most_effects";
    case LedgerEnding::Reason::kNotFitted:
      return "not_fitted";
    case LedgerEnding::Reason::kLittleGain:
      return "little_gain";
    case LedgerEnding::Reason::kMayBeZero:
      return "may_be_zero";
    case LedgerEnding::Reason::kNone:
      break;
  }
  return "";
}

json MeasureToJson(const MisfitMeasure& measure) {
  return {{"frames", measure.frames},
          {"rms_m", measure.rms},
          {"rms_over_sigma", measure.rms_over_sigma}};
}

json ErrorsToJson(const ModelErrors& errors) {
  return {{"in_fit_rms_m", errors.in_fit_rms},
          {"held_out_rms_m", errors.held_out_rms},
          {"held_out_rms_over_sigma", errors.rms_over_sigma},
          {"has_held_out", errors.has_held_out}};
}

json DiagnosisToJson(const DiagnosisRecord& diagnosis, const std::vector<std::string>& added) {
  json tried = json::array();
  for (const RecordedEffect& effect : diagnosis.ranking) {
    if (!effect.refit) continue;
    tried.push_back(
        {{"effect", effect.type},
         {"variant", effect.variant},
         {"first_order_evidence", effect.first_order.evidence},
         {"expected_held_out_rms_over_sigma", effect.first_order.held_out_rms_over_sigma},
         {"message", effect.refit->message},
         {"evidence", effect.refit->evidence},
         {"errors", ErrorsToJson(effect.refit->errors)},
         {"added", std::count(added.begin(), added.end(), effect.type) > 0}});
  }
  json value = {{"chance_evidence", diagnosis.decision.chance}, {"tried", tried}};
  value.update(ConclusionToJson(diagnosis));
  return value;
}

json ModelToJson(const Ledger& ledger, size_t index, const std::filesystem::path& folder) {
  const LedgerModel& model = ledger.models[index];
  json recordings = json::array();
  for (const FittedRecording& recording : model.record.recordings)
    recordings.push_back({{"name", recording.name},
                          {"fitted", recording.fitted},
                          {"in_fit", MeasureToJson(recording.in_fit)},
                          {"held_out", MeasureToJson(recording.held_out)}});
  json parameters = json::array();
  for (const ParameterMove& move : model.moves) {
    json entry = {{"name", move.name},
                  {"unit", move.unit},
                  {"value", move.after},
                  {"low_95", NumberOrNull(move.low)},
                  {"high_95", NumberOrNull(move.high)}};
    if (!move.added && model.parent >= 0) {
      entry["before"] = move.before;
      entry["moved_by_deviations"] = NumberOrNull(move.in_deviations);
    }
    parameters.push_back(entry);
  }
  json entry = {{"model", model.name},
                {"run", model.run.lexically_proximate(folder).generic_string()},
                {"usable", model.record.usable},
                {"message", model.record.message},
                {"noise_m", model.record.noise},
                {"errors", ErrorsToJson(model.errors)},
                {"recordings", recordings},
                {"parameters", parameters}};
  entry["errors"]["held_out_rms_at_measured_places_m"] = model.errors.held_out_at_measured_places;
  if (model.record.scan_noise > 0) entry["scan_noise_m"] = model.record.scan_noise;
  if (model.parent >= 0) {
    entry["parent"] = ledger.models[static_cast<size_t>(model.parent)].name;
    entry["added"] = model.added;
    entry["gain"] = model.gain;
    entry["gain_at_measured_places"] = model.gain_at_measured_places;
    entry["gain_with_reactions"] = model.gain_with_reactions;
    entry["size_may_be_zero"] = model.may_be_zero;
  }
  if (model.diagnosis) {
    std::vector<std::string> added;
    for (const LedgerModel& other : ledger.models)
      if (other.parent == static_cast<int>(index)) added.push_back(other.added);
    entry["diagnosis"] = DiagnosisToJson(*model.diagnosis, added);
  }
  return entry;
}

}  // namespace

const LedgerModel& Ledger::Best() const {
  CHECK(!models.empty());
  size_t best = 0;
  for (size_t k = 1; k < models.size(); ++k)
    if (models[k].parent == static_cast<int>(best) && models[k].record.usable &&
        !models[k].may_be_zero && LowersError(models[k], 0))
      best = k;
  return models[best];
}

std::vector<std::string> Ledger::MayBeLeftOut() const {
  const LedgerModel& best = Best();
  std::vector<std::string> effects;
  for (int at = best.parent; at > 0; at = models[static_cast<size_t>(at)].parent) {
    const LedgerModel& model = models[static_cast<size_t>(at)];
    const LedgerModel& before = models[static_cast<size_t>(model.parent)];
    if (before.diagnosis && SizeMayBeZero(best.record, *before.diagnosis, model.added))
      effects.insert(effects.begin(), model.added);
  }
  return effects;
}

bool LowersError(const LedgerModel& model, double share) {
  // A smaller change of the held-out error is none. Larger: an effect counts that raises it more.
  constexpr double kNoChange = 0.02;
  return model.gain > share || model.gain_with_reactions > share ||
         (model.gain > -kNoChange && model.gain_at_measured_places > std::max(share, kNoChange));
}

bool SizeMayBeZero(const CalibrationRecord& record, const DiagnosisRecord& before,
                   const std::string& added) {
  if (!record.usable) return false;
  std::vector<std::string> names;
  for (const RecordedEffect& effect : before.ranking)
    if (effect.type == added)
      for (const RecordedSize& size : effect.sizes) names.push_back(added + "." + size.parameter);
  bool has_size = false;
  for (const FittedParameter& parameter : record.parameters) {
    if (std::count(names.begin(), names.end(), parameter.name) == 0) continue;
    has_size = true;
    if (parameter.estimate.low > 0 || parameter.estimate.high < 0) return false;
  }
  return has_size;
}

ModelErrors ErrorsOf(const CalibrationRecord& record) {
  struct Sum {
    double square = 0, over_sigma = 0, at_measured_places = 0;
    int points = 0;
    void Add(const MisfitMeasure& measure) {
      square += measure.rms * measure.rms * measure.points;
      over_sigma += measure.rms_over_sigma * measure.rms_over_sigma * measure.points;
      at_measured_places +=
          measure.rms_at_measured_places * measure.rms_at_measured_places * measure.points;
      points += measure.points;
    }
    double Mean(double sum) const { return points > 0 ? std::sqrt(sum / points) : 0; }
  };
  Sum in_fit, held_out;
  for (const FittedRecording& recording : record.recordings) {
    in_fit.Add(recording.in_fit);
    held_out.Add(recording.held_out);
  }
  const Sum& judged = held_out.points > 0 ? held_out : in_fit;
  ModelErrors errors;
  errors.in_fit_rms = in_fit.Mean(in_fit.square);
  errors.held_out_rms = judged.Mean(judged.square);
  errors.rms_over_sigma = errors.without_nuisances = judged.Mean(judged.over_sigma);
  errors.has_held_out = held_out.points > 0;
  errors.held_out_at_measured_places = judged.Mean(judged.at_measured_places);
  return errors;
}

namespace {

// The rms of all measured values over their σ, those of points and of forces and torques: of the
// held-out ones or, where no point was held out, of the fitted ones.
double ErrorWithReactions(const CalibrationRecord& record) {
  const bool has_held_out = ErrorsOf(record).has_held_out;
  double squares = 0, values = 0;
  const auto add = [&](double count, double rms_over_sigma) {
    squares += count * rms_over_sigma * rms_over_sigma;
    values += count;
  };
  for (const FittedRecording& recording : record.recordings) {
    const MisfitMeasure& points = has_held_out ? recording.held_out : recording.in_fit;
    // A scan measures the distance along the normal.
    add((recording.scan ? 1 : 3) * points.points, points.rms_over_sigma);
    for (const FittedReaction& reaction : recording.reactions) {
      const ReactionMeasure& measure = has_held_out ? reaction.held_out : reaction.in_fit;
      add(measure.values, measure.rms_over_sigma);
    }
  }
  return values > 0 ? std::sqrt(squares / values) : 0;
}

}  // namespace

std::vector<ParameterMove> MovesBetween(const CalibrationRecord& before,
                                        const CalibrationRecord& after) {
  std::vector<ParameterMove> moves;
  for (const FittedParameter& parameter : after.parameters) {
    ParameterMove move;
    move.name = parameter.name;
    move.unit = parameter.unit;
    move.after = parameter.estimate.value;
    move.low = parameter.estimate.low;
    move.high = parameter.estimate.high;
    const auto same =
        std::find_if(before.parameters.begin(), before.parameters.end(),
                     [&](const FittedParameter& other) { return other.name == parameter.name; });
    move.added = same == before.parameters.end();
    if (!move.added) {
      move.before = same->estimate.value;
      move.in_deviations = DeviationsTo(move.after, same->estimate, same->log_scale);
    }
    moves.push_back(move);
  }
  return moves;
}

LedgerModel MakeLedgerModel(const Ledger& ledger, const std::filesystem::path& run,
                            const CalibrationRecord& record, int parent, const std::string& added) {
  CHECK_LT(parent, static_cast<int>(ledger.models.size()));
  LedgerModel model;
  model.run = std::filesystem::absolute(run).lexically_normal();
  if (model.run.filename().empty()) model.run = model.run.parent_path();
  model.name = model.run.filename().string();
  model.parent = parent;
  model.added = added;
  model.record = record;
  if (record.usable) model.errors = ErrorsOf(record);
  const LedgerModel* before = parent < 0 ? nullptr : &ledger.models[static_cast<size_t>(parent)];
  model.moves = MovesBetween(before != nullptr ? before->record : CalibrationRecord{}, record);
  if (before != nullptr && record.usable && before->errors.rms_over_sigma > 0)
    model.gain = 1 - model.errors.rms_over_sigma / before->errors.rms_over_sigma;
  if (before != nullptr && record.usable && before->errors.held_out_at_measured_places > 0)
    model.gain_at_measured_places =
        1 - model.errors.held_out_at_measured_places / before->errors.held_out_at_measured_places;
  if (before != nullptr && record.usable)
    if (const double error_before = ErrorWithReactions(before->record); error_before > 0)
      model.gain_with_reactions = 1 - ErrorWithReactions(record) / error_before;
  model.may_be_zero =
      before != nullptr && before->diagnosis && SizeMayBeZero(record, *before->diagnosis, added);
  return model;
}

void WriteLedgerFile(const Ledger& ledger, const std::filesystem::path& folder) {
  const std::filesystem::path from = std::filesystem::absolute(folder).lexically_normal();
  json models = json::array();
  for (size_t k = 0; k < ledger.models.size(); ++k) models.push_back(ModelToJson(ledger, k, from));
  json ending = {{"reason", ReasonName(ledger.ending.reason)}};
  if (ledger.ending.reason == LedgerEnding::Reason::kLittleGain)
    ending["least_gain"] = ledger.ending.least_gain;
  const json all = {{"schema_version", kSchemaVersion},
                    {"finished", ledger.HasEnded()},
                    {"ending", ending},
                    {"best", ledger.Best().name},
                    {"may_be_left_out", ledger.MayBeLeftOut()},
                    {"models", models}};
  WriteFileAtomically(folder / "ledger.json", all.dump(2) + "\n");
}

}  // namespace lacuna
