#include "report/calibration_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "core/quantity.h"
#include "core/text_layout.h"
#include "report/reaction_text.h"

namespace lacuna {
namespace {

// A parameter that finer elements and steps would change by more than this many standard deviations
// gets a note.
constexpr double kMoved = 1;

struct TableText {
  std::string text;
  bool moved = false;  // whether finer elements and steps would move a parameter
};

std::string TableHeader() {
  return fmt::format("\n  {:34} {:>12} {:>25}  {}\n", "parameter", "value", "95 % interval", "");
}

void AppendParameter(const FittedParameter& parameter, TableText* table) {
  const ParameterEstimate& estimate = parameter.estimate;
  std::string note = DeterminationName(estimate.determination);
  if (estimate.determination == Determination::kPinnedDown) note.clear();
  if (estimate.determination == Determination::kTradedOff)
    note +=
        fmt::format(" with {} (correlation {:.2f})", estimate.traded_with, estimate.correlation);
  const double at_limit = parameter.at_limit.value_or(estimate.value);
  if (std::abs(DeviationsTo(at_limit, estimate, parameter.log_scale)) > kMoved) {
    note += fmt::format("{}{:.4g} with {}", note.empty() ? "" : "; ", at_limit,
                        parameter.with_finest_mesh ? "finer elements and steps" : "shorter steps");
    table->moved = true;
  }
  if (const auto& near = parameter.near_bound;
      near && estimate.determination != Determination::kAtBound)
    note += fmt::format("{}near its {} bound {:.4g}", note.empty() ? "" : "; ",
                        near->is_upper ? "upper" : "lower", near->bound);
  table->text += fmt::format("  {:34} {:>12.4g} {:>12.4g} … {:<10.4g}  {:6} {}\n", parameter.name,
                             estimate.value, estimate.low, estimate.high, parameter.unit, note);
}

std::string ParameterTable(const CalibrationRecord& record) {
  TableText table{TableHeader()};
  for (const FittedParameter& parameter : record.parameters) AppendParameter(parameter, &table);
  const bool has_mesh_limit = std::any_of(
      record.parameters.begin(), record.parameters.end(),
      [](const FittedParameter& parameter) { return parameter.with_finest_mesh.has_value(); });
  if (table.moved)
    table.text +=
        has_mesh_limit
            ? "  The intervals are those of the values with infinitely fine elements and time "
              "steps, to which a smaller\n  mesh.max_volume and motion.time_step bring the values "
              "of the model closer.\n"
            : "  The intervals are those of the values with infinitely short time steps, to which "
              "a "
              "smaller\n  motion.time_step brings the values of the model closer.\n";
  return table.text;
}

// Whether the parameter is one of a recording: "recording 1.clock".
bool IsNuisanceParameter(const FittedParameter& parameter, const CalibrationRecord& record) {
  return std::any_of(record.recordings.begin(), record.recordings.end(),
                     [&](const FittedRecording& recording) {
                       return parameter.name.starts_with(recording.name + ".");
                     });
}

std::string HeldText(const CalibrationRecord& record) {
  if (record.held.empty()) return "";
  std::vector<std::string> held;
  for (const HeldParameter& parameter : record.held) {
    std::string values = fmt::format("{:.6g}", fmt::join(parameter.values, ", "));
    if (parameter.values.size() > 1) values = "[" + values + "]";
    held.push_back(fmt::format("{} {}{}{}", parameter.name, values,
                               parameter.unit.empty() ? "" : " ", parameter.unit));
  }
  return Wrapped(fmt::format("held fixed: {}", fmt::join(held, "; ")), "  ", "    ");
}

// Empty where the fit has one kind of data only.
std::string SharesTable(const std::vector<FittedParameter>& parameters) {
  std::string rows, header;
  for (const auto& [name, share] : kDataKinds) header += fmt::format(" {:>9}", name);
  for (const FittedParameter& parameter : parameters) {
    if (!parameter.shares) continue;
    rows += fmt::format("  {:34}", parameter.name);
    for (const auto& [name, share] : kDataKinds)
      rows += fmt::format(" {:>7.0f} %", 100 * (*parameter.shares).*share);
    rows += "\n";
  }
  if (rows.empty()) return "";
  return fmt::format(
      "\n  Share of each kind of data in the information about a parameter, with all other "
      "parameters held fixed:\n  {:34}{}\n{}\n",
      "parameter", header, rows);
}

std::string Describe(const MisfitMeasure& measure) {
  if (measure.points == 0) return "-";
  return fmt::format("{:.3f} mm (largest {:.3f}), {:.1f} σ, {} frames", 1e3 * measure.rms,
                     1e3 * measure.largest, measure.rms_over_sigma, measure.frames);
}

std::string NoiseText(const CalibrationRecord& record) {
  std::string text;
  if (record.noise > 0)
    text += fmt::format(
        "\n  rms distance between predicted and measured markers; σ = {:.3f} mm per coordinate\n",
        1e3 * record.noise);
  if (record.scan_noise > 0)
    text += fmt::format(
        "{}  rms distance between the predicted surface and scanned patches, along the normal;\n"
        "  σ = {:.3f} mm for one point, less for a patch\n",
        record.noise > 0 ? "" : "\n", 1e3 * record.scan_noise);
  return text;
}

std::string TimeStepText(const CalibrationRecord& record) {
  const auto moves = [](const FittedRecording& recording) {
    return recording.in_fit.frames + recording.held_out.frames > 1;
  };
  if (std::none_of(record.recordings.begin(), record.recordings.end(), moves)) return "";
  return fmt::format(
      "  time step {}{}\n", DurationText(record.time_step),
      record.step_error > 0 && std::isfinite(record.step_error)
          ? fmt::format("; halving it would change the prediction by {:.2g} σ", record.step_error)
          : "");
}

std::string RecordingText(const FittedRecording& recording) {
  std::string text =
      fmt::format("  {:14} fitted    {}\n", recording.name, Describe(recording.in_fit));
  text += fmt::format("  {:14} held out  {}\n", "", Describe(recording.held_out));
  std::vector<std::string> own;
  for (const OwnValue& value : recording.own) {
    const bool is_small = value.unit == "m" || value.unit == "rad";
    own.push_back(fmt::format("{} {:.3g} {}", value.name.substr(recording.name.size() + 1),
                              is_small ? 1e3 * value.value : value.value,
                              is_small ? "m" + value.unit : value.unit));
  }
  for (const FittedReaction& reaction : recording.reactions) text += ReactionLines(reaction);
  const std::string margin(17, ' ');
  if (!own.empty())
    text += Wrapped(fmt::format("estimated from its first tenth: {}", fmt::join(own, ", ")), margin,
                    margin);
  if (recording.scan)
    text += fmt::format("  {:14} {} patches, {:.0f} % of the scanned points compared\n", "",
                        recording.scan->places.cols(), 100 * recording.scan->used);
  return text;
}

struct ConflictSentence {
  std::string operator()(const NuisanceParameterConflict& conflict) const {
    return fmt::format("{} is {:.1f} standard deviations of its prior away from 0",
                       conflict.parameter, conflict.deviations);
  }
  std::string operator()(const ModelParameterConflict& conflict) const {
    return fmt::format(
        "{} is {:.1f} standard deviations of its prior away from the prior's mean, {:.4g}{}{}{}",
        conflict.parameter, conflict.deviations, conflict.mean, conflict.unit.empty() ? "" : " ",
        conflict.unit,
        conflict.is_default ? "; this prior is the default one, from the plausible range of the "
                              "parameter: `mean` and `deviation` in `fit` replace it"
                            : "");
  }
  std::string operator()(const MarkerConflict& conflict) const {
    const Eigen::Vector3d offset = 1e3 * conflict.offset;
    return fmt::format(
        "{}: the fit places marker {} ({:.2g}, {:.2g}, {:.2g}) mm away from its recorded place on "
        "the undeformed object; place_deviation is {:.2g} mm",
        conflict.recording, conflict.marker, offset[0], offset[1], offset[2],
        1e3 * conflict.deviation);
  }
  std::string operator()(const MarkerConflictCount& conflict) const {
    return fmt::format("{}: {} of {} markers conflict with their priors; the worst are listed",
                       conflict.recording, conflict.conflicting, conflict.markers);
  }
  std::string operator()(const ReferenceShapeConflict& conflict) const {
    return fmt::format(
        "{}: in frame {}, which must show the object undeformed, the tracked points are {:.2g} mm "
        "(rms) away from the reference shape; place_deviation is {:.2g} mm",
        conflict.recording, conflict.frame, 1e3 * conflict.rms, 1e3 * conflict.deviation);
  }
  std::string operator()(const PatchConflict& conflict) const {
    return fmt::format(
        "{}: {} of {} patches are offset from the model's surface by the same distance in all "
        "frames, up to {:.1f} mm; scan.shape_deviation is {:.1f} mm",
        conflict.recording, conflict.conflicting, conflict.patches, 1e3 * conflict.largest,
        1e3 * conflict.deviation);
  }
  std::string operator()(const UnmatchedScans& conflict) const {
    return fmt::format(
        "{}: in {} of {} frames, the first at {:.3f} s, fewer than {:.0f} % as many scanned points "
        "as in the best frame are within scan.reach of the predicted surface; the others were not "
        "compared",
        conflict.recording, conflict.unmatched, conflict.frames, conflict.first_time,
        100 * conflict.least_share);
  }
};

std::string NotesText(const CalibrationRecord& record) {
  std::string text;
  for (const std::string& note : record.notes) text += Wrapped("note: " + note, "  ", "    ");
  return text;
}

}  // namespace

std::string DescribePriorConflict(const PriorConflict& conflict) {
  return std::visit(ConflictSentence{}, conflict);
}

std::string CalibrationSummary(const CalibrationRecord& record) {
  constexpr int kMostParameters = 6;
  TableText table{TableHeader()};
  int shown = 0;
  for (const FittedParameter& parameter : record.parameters)
    if (!IsNuisanceParameter(parameter, record) && shown < kMostParameters) {
      AppendParameter(parameter, &table);
      ++shown;
    }
  std::string text = table.text + "\n";
  for (const FittedRecording& recording : record.recordings) {
    text += fmt::format("  {:14} fitted    {}\n", recording.name, Describe(recording.in_fit));
    text += fmt::format("  {:14} held out  {}\n", "", Describe(recording.held_out));
    for (const FittedReaction& reaction : recording.reactions) text += ReactionLines(reaction);
  }
  std::vector<std::string> more;
  if (const size_t others = record.parameters.size() - static_cast<size_t>(shown); others > 0)
    more.push_back(fmt::format("{} further parameter{}", others, others == 1 ? "" : "s"));
  if (const size_t conflicts = record.prior_conflicts.size(); conflicts > 0)
    more.push_back(fmt::format("{} conflict{} with priors", conflicts, conflicts == 1 ? "" : "s"));
  if (!more.empty()) text += fmt::format("  {}: --verbose lists them\n", fmt::join(more, " and "));
  return text + NotesText(record);
}

std::string CalibrationReport(const CalibrationRecord& record) {
  std::string text = ParameterTable(record);
  text +=
      SharesTable(record.parameters) + HeldText(record) + NoiseText(record) + TimeStepText(record);
  for (const FittedRecording& recording : record.recordings) text += RecordingText(recording);
  for (const PriorConflict& conflict : record.prior_conflicts)
    text += Wrapped("prior conflict: " + DescribePriorConflict(conflict), "  ", "    ");
  for (const std::string& note : record.mesh_notes) text += Wrapped("mesh: " + note, "  ", "    ");
  return text + NotesText(record);
}

}  // namespace lacuna
