#include "app/fit_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/text_layout.h"

namespace lacuna {
namespace {

// Standard deviations by which finer elements would move a parameter, and it is worth a word.
constexpr double kMoved = 1;

void PrintParameters(const CalibrationRecord& record) {
  bool moved = false;
  fmt::print("\n  {:34} {:>12} {:>25}  {}\n", "parameter", "value", "95 % interval", "");
  for (const FittedParameter& parameter : record.parameters) {
    const ParameterEstimate& estimate = parameter.estimate;
    std::string note = VerdictName(estimate.verdict);
    if (estimate.verdict == ParameterEstimate::Verdict::kPinnedDown) note.clear();
    if (estimate.verdict == ParameterEstimate::Verdict::kTradedOff)
      note +=
          fmt::format(" with {} (correlation {:.2f})", estimate.traded_with, estimate.correlation);
    const double with_finest_mesh = parameter.with_finest_mesh.value_or(estimate.value);
    if (std::abs(DeviationsTo(with_finest_mesh, estimate, parameter.log_scale)) > kMoved) {
      note +=
          fmt::format("{}{:.4g} with finer elements", note.empty() ? "" : "; ", with_finest_mesh);
      moved = true;
    }
    fmt::print("  {:34} {:>12.4g} {:>12.4g} … {:<10.4g}  {:6} {}\n", parameter.name, estimate.value,
               estimate.low, estimate.high, parameter.unit, note);
  }
  if (moved)
    fmt::print(
        "  The intervals count what finer elements would change; a smaller mesh.max_volume makes "
        "them narrower.\n");
}

std::string Describe(const MisfitMeasure& measure) {
  if (measure.points == 0) return "-";
  return fmt::format("{:.3f} mm (largest {:.3f}), {:.1f} σ, {} frames", 1e3 * measure.rms,
                     1e3 * measure.largest, measure.in_noise, measure.frames);
}

void PrintTimeStep(const CalibrationRecord& record) {
  const auto moves = [](const FittedRecording& recording) {
    return recording.in_fit.frames + recording.held_out.frames > 1;
  };
  if (std::none_of(record.recordings.begin(), record.recordings.end(), moves)) return;
  const bool in_seconds = record.time_step >= 1;
  fmt::print("  time step {:.3g} {}{}\n", (in_seconds ? 1 : 1e3) * record.time_step,
             in_seconds ? "s" : "ms",
             record.step_error > 0
                 ? fmt::format("; half of it would change {:.2g} σ", record.step_error)
                 : "");
}

}  // namespace

void PrintCalibration(const CalibrationRecord& record) {
  PrintParameters(record);
  if (record.noise > 0)
    fmt::print(
        "\n  rms distance of predicted from measured markers; σ = {:.3f} mm of a coordinate\n",
        1e3 * record.noise);
  if (record.scan_noise > 0)
    fmt::print(
        "{}  rms distance of the predicted surface from scanned patches, along its normal;\n"
        "  σ = {:.3f} mm of one point, less of a patch\n",
        record.noise > 0 ? "" : "\n", 1e3 * record.scan_noise);
  PrintTimeStep(record);
  for (const FittedRecording& recording : record.recordings) {
    fmt::print("  {:14} fitted    {}\n", recording.name, Describe(recording.in_fit));
    fmt::print("  {:14} held out  {}\n", "", Describe(recording.held_out));
    std::vector<std::string> own;
    for (const OwnValue& value : recording.own) {
      const bool is_small = value.unit == "m" || value.unit == "rad";
      own.push_back(fmt::format("{} {:.3g} {}", value.name.substr(recording.name.size() + 1),
                                is_small ? 1e3 * value.value : value.value,
                                is_small ? "m" + value.unit : value.unit));
    }
    const std::string margin(17, ' ');
    if (!own.empty())
      fmt::print("{}",
                 Wrapped(fmt::format("its own, from its first tenth: {}", fmt::join(own, ", ")),
                         margin, margin));
    if (recording.scan)
      fmt::print("  {:14} {} patches, {:.0f} % of the scanned points compared\n", "",
                 recording.scan->places.cols(), 100 * recording.scan->used);
  }
  for (const std::string& strain : record.strains) fmt::print("  strained: {}\n", strain);
  for (const std::string& note : record.mesh_notes)
    fmt::print("{}", Wrapped("the mesh: " + note, "  ", "    "));
}

}  // namespace lacuna
