#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "comparison/comparison.h"
#include "comparison/unexplained_force_report.h"
#include "core/atomic_file.h"

namespace lacuna {
namespace {

using nlohmann::json;

constexpr double kThroughout = 0.8;    // a span of so much of the frames is all of them
constexpr double kSignificant = 0.01;  // p-values below it

std::string Millimetres(double length) {
  if (std::isnan(length)) return "unknown";
  const double mm = 1e3 * length;
  return mm < 0.1 ? fmt::format("{:.2g} mm", mm) : fmt::format("{:.3f} mm", mm);
}

std::string Chance(double p_value) {
  return p_value <= 0.001 ? "p ≤ 0.001" : fmt::format("p = {:.2g}", p_value);
}

std::string WorstPlaceInWords(const ComparedRecording& recording, const ComparedPart& part) {
  std::string text = fmt::format("Worst is {} {} ({} rms); ", recording.PointName(),
                                 recording.markers[part.worst_marker],
                                 Millimetres(part.of_markers[part.worst_marker]));
  if (part.worst_span.first < 0) return text + "no run of frames stands out.";
  const int span = part.worst_span.last - part.worst_span.first + 1;
  if (span > kThroughout * (part.last - part.first + 1)) {
    text += "no stretch of time is spared";
  } else {
    text += fmt::format("the longest bad stretch is {:.3f} s to {:.3f} s with {} rms",
                        recording.times[part.worst_span.first],
                        recording.times[part.worst_span.last], Millimetres(part.worst_span_rms));
  }
  const MeanVector& error = part.worst_span_error;
  if (error.agreement > 0.5) {
    return text + fmt::format(", where the model lies {} off on average, toward {}.",
                              Millimetres(error.mean.norm()), DirectionInWords(error.mean));
  }
  return text + ", in no common direction.";
}

std::string NoiseInWords(const ComparedPart& part, const char* points) {
  const bool white_in_time = part.in_time.p_value >= kSignificant;
  const bool white_in_space = part.in_space.p_value >= kSignificant;
  if (std::isnan(part.in_time.p_value)) return "Too few frames to tell noise from a trend.";
  std::string text;
  if (white_in_time) {
    text =
        fmt::format("In time the error looks like white noise ({})", Chance(part.in_time.p_value));
  } else {
    text = fmt::format("The error is not noise: neighbouring frames agree (correlation {:.2f}, {})",
                       part.in_time.lag_one, Chance(part.in_time.p_value));
    if (part.in_time.lag_one < 0.2)
      text = fmt::format("In time the error is not white ({})", Chance(part.in_time.p_value));
    if (std::isfinite(part.correlation_time))
      text += fmt::format(", over {:.3g} s", part.correlation_time);
  }
  if (std::isnan(part.in_space.p_value)) return text + ".";
  if (white_in_space)
    return text +
           fmt::format("; the {} err independently ({}).", points, Chance(part.in_space.p_value));
  text += fmt::format("; the {} err together (mean correlation {:.2f}, {}", points,
                      part.in_space.mean_correlation, Chance(part.in_space.p_value));
  if (part.in_space.correlation_length > 0 && std::isfinite(part.in_space.correlation_length))
    text += fmt::format(", over {:.3g} mm", 1e3 * part.in_space.correlation_length);
  if (std::isinf(part.in_space.correlation_length)) text += ", over the whole object";
  return text + ").";
}

// "It rises with speed (rank correlation 0.6): 0.1 mm at 2 mm/s, 0.4 mm at 80 mm/s."
std::string TrendInWords(const ErrorAgainst& against) {
  struct Wording {
    std::string name, unit;
    double scale;
  };
  static const std::map<std::string, Wording> wordings{
      {"time_s", {"time", "s", 1}},
      {"displacement_m", {"displacement", "mm", 1e3}},
      {"speed_m_per_s", {"speed", "mm/s", 1e3}},
      {"strain", {"strain", "%", 100}},
      {"strain_rate_per_s", {"strain rate", "%/s", 100}},
      {"height_m", {"height", "mm", 1e3}},
      {"grip_distance_m", {"distance from the grip", "mm", 1e3}}};
  const Wording& wording = wordings.at(against.quantity);
  const auto at = [&](const ResidualBin& bin) {
    return fmt::format("{} at {:.3g} {}", Millimetres(bin.rms), wording.scale * bin.mean,
                       wording.unit);
  };
  return fmt::format(" It {} with {} (rank correlation {:.2f}): {}, {}.",
                     against.rank_correlation > 0 ? "rises" : "falls", wording.name,
                     against.rank_correlation, at(against.bins.front()), at(against.bins.back()));
}

// The clearest trend in the motion, and the one along the object.
std::string TrendsInWords(const ComparedPart& part) {
  constexpr double kClear = 0.3;
  const ErrorAgainst *in_motion = nullptr, *along = nullptr;
  for (const ErrorAgainst& against : part.against) {
    if (!(std::abs(against.rank_correlation) >= kClear) || against.bins.size() < 2) continue;
    // What goes up and down again is no trend.
    const double change = against.bins.back().rms - against.bins.front().rms;
    if (change * against.rank_correlation <= 0) continue;
    if (against.quantity == "grip_distance_m") {
      along = &against;
    } else if (in_motion == nullptr ||
               std::abs(against.rank_correlation) > std::abs(in_motion->rank_correlation)) {
      in_motion = &against;
    }
  }
  return (in_motion != nullptr ? TrendInWords(*in_motion)
                               : " It goes clearly with nothing in the motion.") +
         (along != nullptr ? TrendInWords(*along) : "");
}

std::string PartInWords(const ComparedRecording& recording, const ComparedPart& part) {
  std::string text = fmt::format("{}, {}, {:.3f} s to {:.3f} s: ", recording.name,
                                 part.fitted ? "fitted" : "held out", recording.times[part.first],
                                 recording.times[part.last]);
  if (part.points == 0) return text + fmt::format("no {} was seen.", recording.PointName());
  text += fmt::format("{} rms, {:.1f} times the noise assumed (σ = {} of a {})",
                      Millimetres(part.rms), part.in_noise, Millimetres(recording.noise),
                      recording.is_scan ? "patch along its normal" : "coordinate");
  if (!std::isnan(part.in_floor))
    text += fmt::format(", {:.1f} times the recording's own floor ({})", part.in_floor,
                        Millimetres(recording.floor));
  text += fmt::format("; largest {} at {} {}, {:.3f} s. ", Millimetres(part.largest),
                      recording.PointName(), recording.markers[part.largest_marker],
                      recording.times[part.largest_column]);
  if (part.in_noise >= kBeyondNoise && part.steady > part.changing) {
    text += fmt::format(
        "Most of it, {}, is the same in all frames, as of {}, a frame that is turned or a steady "
        "load; {} change. ",
        Millimetres(part.steady), recording.is_scan ? "another rest shape" : "misplaced markers",
        Millimetres(part.changing));
  }
  text += NoiseInWords(part, recording.is_scan ? "patches" : "markers");
  if (part.in_noise < kBeyondNoise && part.in_time.p_value >= kSignificant &&
      !(part.in_space.p_value < kSignificant))
    return text + " Nothing here contradicts the model.";
  return text + " " + WorstPlaceInWords(recording, part) + TrendsInWords(part);
}

json Number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }
json Numbers(const Eigen::Ref<const Eigen::VectorXd>& values) {
  json list = json::array();
  for (const double value : values) list.push_back(Number(value));
  return list;
}
// A scale that exceeds what was seen is told as such, JSON having no infinity.
json Scale(double value) {
  return std::isinf(value) ? json("longer than the data") : Number(value);
}

json ToJson(const ComparedRecording& recording, const ComparedPart& part) {
  json pairs = json::array();
  // Of the patches of a scan there are too many to be listed.
  for (const PointPair& pair : recording.is_scan ? std::vector<PointPair>() : part.in_space.pairs)
    pairs.push_back({{"markers", {pair.first, pair.second}},
                     {"distance_m", Number(pair.distance)},
                     {"correlation", Number(pair.correlation)}});
  json against = json::object();
  for (const ErrorAgainst& entry : part.against)
    against[entry.quantity] = {{"rank_correlation", Number(entry.rank_correlation)}};
  json worst_span = nullptr;
  if (part.worst_span.first >= 0) {
    worst_span = {{"first_frame", recording.frames[part.worst_span.first]},
                  {"last_frame", recording.frames[part.worst_span.last]},
                  {"from_s", recording.times[part.worst_span.first]},
                  {"to_s", recording.times[part.worst_span.last]},
                  {"rms_m", Number(part.worst_span_rms)},
                  {"mean_difference_m", Numbers(part.worst_span_error.mean)},
                  {"agreement", Number(part.worst_span_error.agreement)}};
  }
  return {{"part", part.fitted ? "fitted" : "held out"},
          {"frames", part.last - part.first + 1},
          {"from_s", recording.times[part.first]},
          {"to_s", recording.times[part.last]},
          {"points", part.points},
          {"rms_m", Number(part.rms)},
          {"in_noise", Number(part.in_noise)},
          {"in_floor", Number(part.in_floor)},
          {"steady_m", Number(part.steady)},
          {"changing_m", Number(part.changing)},
          {"largest_m", Number(part.largest)},
          {"largest_marker", part.largest_marker},
          {"mean_difference_m", Numbers(part.mean_error.mean)},
          {"agreement", Number(part.mean_error.agreement)},
          {"marker_rms_m", Numbers(part.of_markers)},
          {"worst_marker", part.worst_marker},
          {"worst_span", worst_span},
          {"in_time",
           {{"lags", part.in_time.lags},
            {"ljung_box_statistic", Number(part.in_time.statistic)},
            {"lag_one_correlation", Number(part.in_time.lag_one)},
            {"p_value", Number(part.in_time.p_value)},
            {"correlation_time_s", Scale(part.correlation_time)}}},
          {"in_space",
           {{"mean_correlation", Number(part.in_space.mean_correlation)},
            {"p_value", Number(part.in_space.p_value)},
            {"correlation_length_m", Scale(part.in_space.correlation_length)},
            {"pairs", pairs}}},
          {"against", against}};
}

json ToJson(const Comparison& comparison) {
  json recordings = json::array();
  for (const ComparedRecording& recording : comparison.recordings) {
    json rests = json::array();
    for (const StaticSpan& rest : recording.rests)
      rests.push_back({{"from_s", recording.times[rest.first]},
                       {"to_s", recording.times[rest.last]},
                       {"deviation_m", Number(rest.deviation)},
                       {"drift_m_per_s", Number(rest.drift)}});
    json parts = json::array();
    for (const ComparedPart& part : recording.parts) parts.push_back(ToJson(recording, part));
    json distances = nullptr;
    if (recording.grip_distance.size() > 0) distances = Numbers(recording.grip_distance);
    json force = nullptr, height = nullptr;
    if (recording.force) {
      force = ToJson(*recording.force);
      height = recording.height_by_gravity ? "against gravity" : "z";
    }
    recordings.push_back({{"name", recording.name},
                          {"markers", recording.markers},
                          {"grip_distance_m", distances},
                          {"floor_m", Number(recording.floor)},
                          {"white_noise_m", Number(recording.white_noise)},
                          {"rest_deviation_m", Number(recording.rest_deviation)},
                          {"rests", rests},
                          {"parts", parts},
                          {"height_along", height},
                          {"field_frames", recording.field_frames},
                          {"unexplained_force", force}});
  }
  json pairs = json::array();
  for (const ComparedPair& pair : comparison.pairs)
    pairs.push_back({{"recordings", {pair.first, pair.second}},
                     {"frames", pair.repeatability.frames},
                     {"delay_s", Number(pair.repeatability.delay)},
                     {"distance_m", Number(pair.repeatability.distance)}});
  return {{"schema_version", 1},       {"noise_m", comparison.noise},
          {"recordings", recordings},  {"pairs", pairs},
          {"notes", comparison.notes}, {"in_words", ComparisonInWords(comparison)}};
}

std::string ByFrame(const Comparison& comparison) {
  std::string text =
      "recording,frame,time_s,fitted,points,rms_m,in_noise,largest_m,mean_difference_x_m,"
      "mean_difference_y_m,mean_difference_z_m\n";
  for (size_t r = 0; r < comparison.recordings.size(); ++r) {
    const ComparedRecording& recording = comparison.recordings[r];
    const Eigen::MatrixXd lengths = PointLengths(recording.difference);
    for (int f = 0; f < static_cast<int>(recording.frames.size()); ++f) {
      int points = 0;
      double largest = kUnknown;
      for (const double length : lengths.col(f)) {
        points += !std::isnan(length);
        largest = std::fmax(largest, length);
      }
      const double rms = Rms(lengths.col(f));
      const Eigen::Vector3d mean = MeanOver(recording.difference, f, f).mean;
      text += fmt::format("{},{},{},{:d},{},{},{},{},{},{},{}\n", r, recording.frames[f],
                          recording.times[f], recording.fitted[f] != 0, points, rms,
                          rms / recording.LengthOf(recording.noise), largest, mean[0], mean[1],
                          mean[2]);
    }
  }
  return text;
}

std::string ByMarker(const Comparison& comparison) {
  std::string text =
      "recording,marker,fitted,frames,rms_m,in_noise,largest_m,mean_difference_x_m,"
      "mean_difference_y_m,mean_difference_z_m,mean_place_x_m,mean_place_y_m,mean_place_z_m\n";
  for (size_t r = 0; r < comparison.recordings.size(); ++r) {
    const ComparedRecording& recording = comparison.recordings[r];
    const Eigen::MatrixXd lengths = PointLengths(recording.difference);
    const Eigen::Matrix3Xd& places = recording.mean_places;
    for (const ComparedPart& part : recording.parts) {
      for (Eigen::Index m = 0; m < lengths.rows(); ++m) {
        int frames = 0;
        double largest = kUnknown;
        for (const double length : lengths.row(m).segment(part.first, part.last - part.first + 1)) {
          frames += !std::isnan(length);
          largest = std::fmax(largest, length);
        }
        const Eigen::Vector3d mean =
            MeanOver(recording.difference.middleRows<3>(3 * m), part.first, part.last).mean;
        text += fmt::format("{},{},{:d},{},{},{},{},{},{},{},{},{},{}\n", r, m, part.fitted, frames,
                            part.of_markers[m],
                            part.of_markers[m] / recording.LengthOf(recording.noise), largest,
                            mean[0], mean[1], mean[2], places(0, m), places(1, m), places(2, m));
      }
    }
  }
  return text;
}

std::string Against(const Comparison& comparison) {
  std::string text = "recording,fitted,quantity,low,high,mean,count,rms_m,in_noise\n";
  for (size_t r = 0; r < comparison.recordings.size(); ++r) {
    const ComparedRecording& recording = comparison.recordings[r];
    for (const ComparedPart& part : recording.parts)
      for (const ErrorAgainst& against : part.against)
        for (const ResidualBin& bin : against.bins)
          text += fmt::format("{},{:d},{},{},{},{},{},{},{}\n", r, part.fitted, against.quantity,
                              bin.low, bin.high, bin.mean, bin.points, bin.rms,
                              bin.rms / recording.LengthOf(recording.noise));
  }
  return text;
}

}  // namespace

std::vector<std::string> ComparisonInWords(const Comparison& comparison) {
  std::vector<std::string> sentences;
  for (const ComparedRecording& recording : comparison.recordings) {
    for (const ComparedPart& part : recording.parts)
      sentences.push_back(PartInWords(recording, part));
    if (recording.is_scan) continue;  // its floor is that of its points, and stands above
    std::string floor = fmt::format("{}, noise in the measurement: white part {} of a coordinate",
                                    recording.name, Millimetres(recording.white_noise));
    if (recording.rests.empty()) {
      floor += "; the object nowhere rests long enough to see more.";
    } else {
      double drift = 0;
      for (const StaticSpan& rest : recording.rests) drift = std::fmax(drift, rest.drift);
      floor += fmt::format("; at rest ({} {}) {} about a line, drifting by up to {}/s.",
                           recording.rests.size(), recording.rests.size() == 1 ? "span" : "spans",
                           Millimetres(recording.rest_deviation), Millimetres(drift));
    }
    constexpr double kFarFromOne = 2;
    const double ratio = recording.noise / recording.floor;
    if (ratio > kFarFromOne || ratio < 1 / kFarFromOne) {
      floor += fmt::format(" The fit weighed with σ = {}, {:.2g} times that floor.",
                           Millimetres(recording.noise), ratio);
    }
    sentences.push_back(floor);
    if (recording.force) sentences.push_back(ForceInWords(*recording.force, recording.name));
  }
  for (const ComparedPair& pair : comparison.pairs) {
    sentences.push_back(fmt::format(
        "{} and {} differ by {} rms as measured, over {} frames and with {} {:.4f} s {}: if "
        "they are repeats, no model can come nearer to either than {}.",
        pair.first, pair.second, Millimetres(pair.repeatability.distance),
        pair.repeatability.frames, pair.second, std::abs(pair.repeatability.delay),
        pair.repeatability.delay < 0 ? "earlier" : "later",
        Millimetres(pair.repeatability.distance / std::sqrt(2.0))));
  }
  return sentences;
}

void SaveComparison(const Comparison& comparison, const std::filesystem::path& run) {
  const std::filesystem::path folder = run / "comparison";
  MakeFolder(folder);
  WriteFileAtomically(folder / "by_frame.csv", ByFrame(comparison));
  WriteFileAtomically(folder / "by_marker.csv", ByMarker(comparison));
  WriteFileAtomically(folder / "against.csv", Against(comparison));
  std::string forces;
  for (size_t r = 0; r < comparison.recordings.size(); ++r) {
    const std::optional<UnexplainedForce>& force = comparison.recordings[r].force;
    if (force && force->usable) forces += ForceTableRows(*force, r);
  }
  const std::filesystem::path force_file = folder / "unexplained_force.csv";
  if (forces.empty()) {
    std::filesystem::remove(force_file);  // of an earlier comparison
  } else {
    WriteFileAtomically(force_file, ForceTableHeader() + forces);
  }
  WriteFileAtomically(folder / "comparison.json", ToJson(comparison).dump(2) + "\n");
}

}  // namespace lacuna
