#include "report/comparison_report.h"

#include <fmt/format.h>

#include <cmath>

#include "core/text_layout.h"
#include "record/model_errors.h"
#include "report/error_trend_text.h"
#include "report/quantity_text.h"
#include "report/reaction_text.h"
#include "report/unexplained_force_report.h"

namespace lacuna {
namespace {

// Thresholds for the sentences.
constexpr double kWholePart = 0.8;     // a bad period of a larger share of frames is the whole part
constexpr double kSignificant = 0.01;  // p-values below this are significant
constexpr double kClearCorrelation = 0.2;  // correlation of neighbouring frames
constexpr double kSameDirection = 0.5;     // agreement of the errors' directions, 0 to 1
constexpr double kFarFromFloor = 2;        // ratio of the assumed noise to the measured one
// The object drifts while it rests where the slope is this many times that which noise alone gives:
// below, a few frames at rest would show a drift; above, slow drift of long rests goes unmentioned.
constexpr double kClearDrift = 3;
// An error at the measured places is reported where it is so many times that at the fitted places.
constexpr double kHiddenByPlaces = 1.1;

bool IsWhite(double p_value) { return p_value >= kSignificant; }

// The multiple of the noise that the fit assumed.
std::string MultipleText(const ComparedRecording& recording, const ErrorSize& error) {
  const double noise_rms = recording.RmsOfNoise(recording.noise);
  if (HaveEqualNoise(error.rms, error.rms_over_sigma, noise_rms))
    return fmt::format(
        "{:.1f} times the {} that noise alone would give (σ = {} {}, as assumed in the fit)",
        error.rms_over_sigma, Millimetres(noise_rms), Millimetres(recording.noise),
        recording.is_scan ? "for a patch along its normal" : "per coordinate");
  return fmt::format(
      "{:.1f} times what noise alone would give, where each {} counts in units of its own σ ({} "
      "{}, as assumed in the fit)",
      error.rms_over_sigma, recording.is_scan ? "patch" : "marker", Millimetres(recording.noise),
      recording.is_scan ? "for a typical patch along its normal"
                        : "per coordinate for a typical marker");
}

std::string SizeText(const ComparedRecording& recording, const ErrorSize& error) {
  std::string text = fmt::format("the rms error is {}, {}", Millimetres(error.rms),
                                 MultipleText(recording, error));
  if (!std::isnan(error.rms_over_floor))
    text += fmt::format(" and {:.1f} times the noise that the recording itself shows ({})",
                        error.rms_over_floor,
                        Millimetres(recording.RmsOfNoise(recording.noise_floor.floor)));
  text += fmt::format(". The largest error is {} ({} {}, at {:.3f} s).", Millimetres(error.largest),
                      recording.is_scan ? "patch" : "marker",
                      recording.point_names[error.largest_point], error.largest_time);
  if (error.rms_over_sigma >= kBeyondNoise && error.steady > error.changing) {
    text += fmt::format(
        " Most of the error, {} rms, is the same in all frames; {}, a rotated coordinate system or "
        "a steady load would cause this. The part that varies is {} rms.",
        Millimetres(error.steady),
        recording.is_scan ? "a different rest shape" : "misplaced markers",
        Millimetres(error.changing));
  }
  return text;
}

// The error with the points where they were measured, where the fitted places hide much of it.
std::string PlacesText(const ComparedRecording& recording, const ComparedPart& part) {
  if (!(part.rms_at_measured_places > kHiddenByPlaces * part.error.rms)) return "";
  return fmt::format(
      " With every {0} at the place where it was measured, the rms error is {1}: the fit has moved "
      "the places within their uncertainty.",
      recording.is_scan ? "patch" : "marker", Millimetres(part.rms_at_measured_places));
}

std::string TimeText(const TimeCorrelation& in_time) {
  const std::string probability = ProbabilityText(in_time.p_value);
  if (IsWhite(in_time.p_value))
    return fmt::format(" In time, the error is consistent with white noise ({}).", probability);
  std::string text =
      in_time.lag_one < kClearCorrelation
          ? fmt::format(" In time, the error is not white noise ({}", probability)
          : fmt::format(" The error is not noise: neighbouring frames are correlated ({:.2f}, {}",
                        in_time.lag_one, probability);
  if (std::isfinite(in_time.time)) text += fmt::format(", correlation time {:.3g} s", in_time.time);
  return text + ").";
}

std::string SpaceText(const SpaceCorrelation& in_space, const char* points) {
  if (std::isnan(in_space.p_value)) return "";
  const std::string probability = ProbabilityText(in_space.p_value);
  if (IsWhite(in_space.p_value))
    return fmt::format(" The errors of different {} are independent ({}).", points, probability);
  std::string text = fmt::format(" The errors of different {} are correlated (mean {:.2f}, {}",
                                 points, in_space.mean, probability);
  if (in_space.length > 0 && std::isfinite(in_space.length))
    text += fmt::format(", correlation length {:.3g} mm", 1e3 * in_space.length);
  if (std::isinf(in_space.length)) text += ", over the whole object";
  return text + ").";
}

std::string NoiseText(const ComparedRecording& recording, const ComparedPart& part) {
  if (std::isnan(part.in_time.p_value))
    return " There are too few frames to distinguish noise from a trend.";
  return TimeText(part.in_time) +
         SpaceText(part.in_space, recording.is_scan ? "patches" : "markers");
}

std::string WorstText(const ComparedRecording& recording, const ComparedPart& part) {
  std::string text = fmt::format(
      " {} {} has the largest rms error, {}.", recording.is_scan ? "Patch" : "Marker",
      recording.point_names[part.worst_point], Millimetres(part.point_rms[part.worst_point]));
  if (!part.worst_period) return text + " No period is clearly worse than the others.";
  const WorstPeriod& period = *part.worst_period;
  if (period.frames > kWholePart * part.frames) {
    text += " The error is large throughout";
  } else {
    text += fmt::format(" The longest bad period is {:.3f} s to {:.3f} s with {} rms", period.from,
                        period.to, Millimetres(period.rms));
  }
  const MeanDifference& difference = period.mean_difference;
  if (!(difference.agreement > kSameDirection)) return text + ", in no common direction.";
  return text + fmt::format("; the prediction is displaced by {} on average, toward {}.",
                            Millimetres(difference.mean.norm()), DirectionText(difference.mean));
}

std::string DescribePart(const ComparedRecording& recording, const ComparedPart& part) {
  const std::string title = fmt::format("{}, {} frames, {:.3f} s to {:.3f} s: ", recording.name,
                                        part.fitted ? "fitted" : "held-out", part.from, part.to);
  if (part.error.points == 0)
    return title + fmt::format("no {} was observed.", recording.is_scan ? "patch" : "marker");
  const std::string text = title + SizeText(recording, part.error) + PlacesText(recording, part) +
                           NoiseText(recording, part);
  const bool is_noise = part.error.rms_over_sigma < kBeyondNoise && IsWhite(part.in_time.p_value) &&
                        !(part.in_space.p_value < kSignificant);
  if (is_noise) return text + " Nothing here contradicts the model.";
  return text + WorstText(recording, part) + DescribeTrends(part.trends);
}

std::string DescribeNoise(const ComparedRecording& recording) {
  const NoiseFloor& noise_floor = recording.noise_floor;
  std::string text = fmt::format(
      "{}, noise of the measurement: the white part has a standard deviation of {} per "
      "coordinate.",
      recording.name, Millimetres(noise_floor.white));
  if (noise_floor.rests.empty()) {
    text += " The object never rests long enough to show slower noise.";
  } else {
    double drift = 0;
    for (const RestPeriod& rest : noise_floor.rests)
      if (rest.drift > kClearDrift * rest.noise_drift) drift = std::fmax(drift, rest.drift);
    text += fmt::format(
        " While the object rests ({} {}), coordinates scatter by {} about a straight line",
        noise_floor.rests.size(), noise_floor.rests.size() == 1 ? "period" : "periods",
        Millimetres(noise_floor.rest_deviation));
    text += drift > 0 ? fmt::format(" and drift by up to {} per second.", Millimetres(drift)) : ".";
  }
  const double ratio = recording.noise / noise_floor.floor;
  if (ratio > kFarFromFloor || ratio < 1 / kFarFromFloor) {
    text += fmt::format(" The fit assumed {}, which is {:.2g} times as much.",
                        Millimetres(recording.noise), ratio);
  }
  return text;
}

std::string DescribeLoadedMost(const LoadedMost& loaded, const std::string& recording) {
  const auto place = [](const Eigen::Vector3d& at) {
    return fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", 1e3 * at.x(), 1e3 * at.y(), 1e3 * at.z());
  };
  return fmt::format(
      "{}, stress of the model: the von Mises stress is largest at {:.3f} s, {:.3g} kPa at {} of "
      "the undeformed object; the largest principal stretch is {:.3f}, at {:.3f} s and {}. At the "
      "edge of a clamp such values grow without limit as the mesh is refined.",
      recording, loaded.von_mises_time, 1e-3 * loaded.von_mises, place(loaded.von_mises_place),
      loaded.stretch, loaded.stretch_time, place(loaded.stretch_place));
}

std::string DescribePair(const ComparedPair& pair) {
  return fmt::format(
      "{} and {}, as measured, differ by {} rms over {} frames if {} is shifted {:.4f} s {}. If "
      "both repeat the same experiment, a right model is expected to have an rms error of about {} "
      "in each.",
      pair.first, pair.second, Millimetres(pair.distance), pair.frames, pair.second,
      std::abs(pair.delay), pair.delay > 0 ? "earlier" : "later",
      Millimetres(pair.distance / std::sqrt(2.0)));
}

// What the two rms errors of the table are; empty where only one is known.
std::string ExplainPlaces(const ComparisonRecord& record) {
  bool is_known = false, has_markers = false, has_scans = false;
  for (const ComparedRecording& recording : record.recordings) {
    (recording.is_scan ? has_scans : has_markers) = true;
    for (const ComparedPart& part : recording.parts)
      is_known = is_known || !std::isnan(part.rms_at_measured_places);
  }
  if (!is_known) return "";
  const char* point = has_scans && has_markers ? "marker or patch" : has_scans ? "patch" : "marker";
  const char* uncertainty = has_scans && has_markers ? "place_deviation, scan.shape_deviation"
                            : has_scans              ? "scan.shape_deviation"
                                                     : "place_deviation";
  return "\n" + Wrapped(fmt::format(
                            "rms: with each {0} at the place on the object that the fit gives it "
                            "within the uncertainty of its measurement ({1}). as measured: with "
                            "each {0} at the place where it was measured. Where the second is much "
                            "larger, the fit ascribes the difference to errors of these places.",
                            point, uncertainty),
                        "  ", "  ");
}

}  // namespace

std::string ComparisonTable(const ComparisonRecord& record) {
  const auto row = [](const std::string& name, const std::string& part, const std::string& frames,
                      const std::string& rms, const std::string& as_measured,
                      const std::string& over_sigma, const std::string& over_floor,
                      const std::string& correlation, const std::string& worst) {
    return "  " + PaddedRight(name, 15) + PaddedRight(part, 9) + PaddedLeft(frames, 6) +
           PaddedLeft(rms, 10) + PaddedLeft(as_measured, 13) + PaddedLeft(over_sigma, 9) +
           PaddedLeft(over_floor, 12) + PaddedLeft(correlation, 12) + PaddedLeft(worst, 12) + "\n";
  };
  const auto number = [](double value, int decimals) {
    return std::isnan(value) ? std::string("-") : fmt::format("{:.{}f}", value, decimals);
  };
  std::string table = row("recording", "frames", "count", "rms (mm)", "as measured", "rms / σ",
                          "rms / floor", "lag-1 corr.", "worst point");
  for (const ComparedRecording& recording : record.recordings) {
    for (const ComparedPart& part : recording.parts) {
      table += row(recording.name, part.fitted ? "fitted" : "held out", std::to_string(part.frames),
                   number(1e3 * part.error.rms, 3), number(1e3 * part.rms_at_measured_places, 3),
                   number(part.error.rms_over_sigma, 1), number(part.error.rms_over_floor, 1),
                   number(part.in_time.lag_one, 2),
                   part.worst_point < 0 ? "-" : recording.point_names[part.worst_point]);
    }
  }
  table += ExplainPlaces(record);
  for (const ComparedRecording& recording : record.recordings) {
    if (recording.reactions.empty()) continue;
    table += fmt::format("\n  measured forces of {}: rms error of a component\n", recording.name);
    for (const FittedReaction& reaction : recording.reactions) table += ReactionLines(reaction);
  }
  return table;
}

std::vector<std::string> DescribeComparison(const ComparisonRecord& record) {
  std::vector<std::string> paragraphs;
  for (const ComparedRecording& recording : record.recordings) {
    for (const ComparedPart& part : recording.parts)
      paragraphs.push_back(DescribePart(recording, part));
    if (!recording.is_scan) paragraphs.push_back(DescribeNoise(recording));
    for (const FittedReaction& reaction : recording.reactions)
      paragraphs.push_back(DescribeReactionFit(reaction, recording.name));
    if (recording.loaded_most)
      paragraphs.push_back(DescribeLoadedMost(*recording.loaded_most, recording.name));
    if (recording.force)
      paragraphs.push_back(DescribeUnexplainedForce(*recording.force, recording.name));
  }
  for (const ComparedPair& pair : record.pairs) paragraphs.push_back(DescribePair(pair));
  return paragraphs;
}

}  // namespace lacuna
