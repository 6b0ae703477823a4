#include "comparison/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "calibration/calibration_run.h"
#include "core/error.h"
#include "experiment/reference_body.h"
#include "prediction/prediction_study.h"
#include "prediction/prediction_study_reader.h"
#include "record/csv_table.h"
#include "record/run_directory.h"

namespace lacuna {
namespace {

using nlohmann::json;

constexpr int kBins = 10;
constexpr int kFewestAtRest = 10;
// A point rests while it moves less than this many standard deviations of the distance between two
// measurements of the same place: seldom left by noise alone.
constexpr double kRestThreshold = 2;
constexpr int kFewestOfSpan = 3;       // bad frames that make a span of time
constexpr double kLargestGap = 0.05;   // of the frames, within such a span
constexpr double kLargestDelay = 0.1;  // s, between two recordings' clocks beyond their release

const Eigen::VectorXd& Column(const CsvTable& table, const std::string& name,
                              const std::filesystem::path& file) {
  for (const CsvColumn& column : table)
    if (column.name == name) return column.values;
  throw InputError({file.string()}, "has no column " + name);
}

// Rows of the table of one recording, by frame and marker.
ComparedRecording ReadRecordingRows(const CsvTable& table, int recording,
                                    const std::filesystem::path& file) {
  const Eigen::VectorXd& of = Column(table, "recording", file);
  const Eigen::VectorXd& frame = Column(table, "frame", file);
  const Eigen::VectorXd& time = Column(table, "time_s", file);
  const Eigen::VectorXd& marker = Column(table, "marker", file);
  const Eigen::VectorXd& fitted = Column(table, "fitted", file);
  ComparedRecording result;
  std::map<int, Eigen::Index> column_of;
  int markers = 0;
  std::vector<double> times;
  for (Eigen::Index row = 0; row < of.size(); ++row) {
    if (of[row] != recording) continue;
    markers = std::max(markers, static_cast<int>(marker[row]) + 1);
    const int here = static_cast<int>(frame[row]);
    if (!column_of.emplace(here, static_cast<Eigen::Index>(result.frames.size())).second) continue;
    if (!times.empty() && time[row] <= times.back())
      throw InputError({file.string()}, "its frames are not in the order of time");
    result.frames.push_back(here);
    times.push_back(time[row]);
    result.fitted.push_back(fitted[row] != 0);
  }
  const Eigen::Index frames = static_cast<Eigen::Index>(times.size());
  result.times = Eigen::Map<const Eigen::VectorXd>(times.data(), frames);
  result.measured = Eigen::MatrixXd::Constant(3 * markers, frames, kUnknown);
  result.difference = result.measured;
  for (int axis = 0; axis < 3; ++axis) {
    const auto named = [&](const std::string& what) -> const Eigen::VectorXd& {
      return Column(table, fmt::format("{}_{}_m", what, "xyz"[axis]), file);
    };
    const Eigen::VectorXd &measured = named("measured"), &difference = named("difference");
    for (Eigen::Index row = 0; row < of.size(); ++row) {
      if (of[row] != recording) continue;
      const Eigen::Index column = column_of.at(static_cast<int>(frame[row]));
      const Eigen::Index at = 3 * static_cast<Eigen::Index>(marker[row]) + axis;
      if (at < 0) throw InputError({file.string()}, "has a negative number of a marker");
      result.measured(at, column) = measured[row];
      result.difference(at, column) = difference[row];
    }
  }
  return result;
}

// Distance of each place from the nearest node that the recording holds or moves; empty: no grip.
Eigen::VectorXd GripDistances(const Recording& recording, const Eigen::Matrix3Xd& places,
                              const Eigen::Matrix3Xd& nodes) {
  std::vector<Region> regions = recording.object.fixed;
  for (const RecordedGrip& grip : recording.object.grips) regions.push_back(grip.region);
  Eigen::VectorXd distances =
      Eigen::VectorXd::Constant(places.cols(), std::numeric_limits<double>::infinity());
  for (const Region& region : regions)
    for (const int node : SelectNodes(region, nodes))
      for (Eigen::Index m = 0; m < distances.size(); ++m)
        distances[m] = std::min(distances[m], (places.col(m) - nodes.col(node)).norm());
  return regions.empty() ? Eigen::VectorXd() : distances;
}

// Whether the item is what the run was made from.
bool IsThat(const ComparedRecording& recording, const PredictedRecording& item) {
  if (item.name != recording.name || item.frames != recording.frames) return false;
  if (recording.is_scan || item.scans != nullptr) return recording.is_scan && item.scans != nullptr;
  const Eigen::Matrix3Xd& first = item.recording.markers.positions[recording.frames.front()];
  if (3 * first.cols() != recording.measured.rows()) return false;
  for (Eigen::Index m = 0; m < first.cols(); ++m)
    for (int axis = 0; axis < 3; ++axis) {
      const double now = first(axis, m), then = recording.measured(3 * m + axis, 0);
      if (now != then && !(std::isnan(now) && std::isnan(then))) return false;
    }
  return true;
}

void AddWhatTheRecordingsTell(const std::filesystem::path& run, const CalibrationRecord& record,
                              Comparison* comparison) {
  std::string problem;
  try {
    const PredictionStudy study =
        ReadPredictionStudy(Config::Load((run / record.experiment).lexically_normal()));
    const ReferenceBody body = ReadReferenceBody(FinishedStage(run, "mesh"));
    for (size_t r = 0; r < comparison->recordings.size(); ++r) {
      ComparedRecording& recording = comparison->recordings[r];
      if (r >= study.recordings.size() || !IsThat(recording, study.recordings[r])) {
        problem = fmt::format("{} is not what the run was made from any more", recording.name);
        continue;
      }
      const Recording& now = study.recordings[r].recording;
      if (!recording.is_scan) recording.markers = now.markers.names;
      recording.grip_distance = GripDistances(
          now, recording.is_scan ? record.recordings[r].scan->places : now.markers.places,
          body.mesh.nodes);
    }
  } catch (const InputError& error) {
    problem = error.what();
  }
  if (!problem.empty()) {
    comparison->notes.push_back(
        "Markers are told by number, from 0, and not by their distance from the grip: " + problem);
  }
}

void MeasureNoise(ComparedRecording* recording) {
  const double sigma = recording->noise;
  recording->white_noise = WhiteNoise(recording->measured);
  const double noise = std::isnan(recording->white_noise) || recording->white_noise == 0
                           ? sigma
                           : recording->white_noise;
  // The distance of two measurements of one place has the rms √6 σ.
  recording->rests = StaticSpans(recording->times, recording->measured,
                                 kRestThreshold * std::sqrt(6.0) * noise, kFewestAtRest);
  std::vector<double> deviations;
  for (const StaticSpan& rest : recording->rests)
    if (!std::isnan(rest.deviation)) deviations.push_back(rest.deviation);
  if (!deviations.empty()) {
    std::nth_element(deviations.begin(), deviations.begin() + deviations.size() / 2,
                     deviations.end());
    recording->rest_deviation = deviations[deviations.size() / 2];
  }
  recording->floor = std::fmax(recording->white_noise, recording->rest_deviation);
}

// Mean place of each marker over all frames: where in space its error is.
Eigen::Matrix3Xd MeanPlaces(const Eigen::MatrixXd& measured) {
  Eigen::Matrix3Xd places(3, measured.rows() / 3);
  for (Eigen::Index m = 0; m < places.cols(); ++m)
    places.col(m) =
        MeanOver(measured.middleRows<3>(3 * m), 0, static_cast<int>(measured.cols()) - 1).mean;
  return places;
}

ComparedPart MeasurePart(const ComparedRecording& recording, bool fitted, int first, int last) {
  const Eigen::Index begin = first, count = last - first + 1;
  const Eigen::MatrixXd difference = recording.difference.middleCols(begin, count);
  const Eigen::MatrixXd lengths = PointLengths(difference);
  ComparedPart part;
  part.fitted = fitted;
  part.first = first;
  part.last = last;
  part.rms = Rms(lengths);
  part.of_markers = RmsOfPoints(lengths);
  for (Eigen::Index f = 0; f < lengths.cols(); ++f) {
    for (Eigen::Index m = 0; m < lengths.rows(); ++m) {
      if (std::isnan(lengths(m, f))) continue;
      ++part.points;
      if (lengths(m, f) <= part.largest) continue;
      part.largest = lengths(m, f);
      part.largest_marker = static_cast<int>(m);
      part.largest_column = first + static_cast<int>(f);
    }
  }
  for (int m = 0; m < part.of_markers.size(); ++m)
    if (!std::isnan(part.of_markers[m]) &&
        (part.worst_marker < 0 || part.of_markers[m] > part.of_markers[part.worst_marker]))
      part.worst_marker = m;
  part.in_noise = part.rms / recording.LengthOf(recording.noise);
  if (recording.floor > 0) part.in_floor = part.rms / recording.LengthOf(recording.floor);

  part.changing = Rms(PointLengths(Centred(difference)));
  part.steady = std::sqrt(std::max(0.0, part.rms * part.rms - part.changing * part.changing));

  part.in_time = WhitenessInTime(difference);
  const Eigen::VectorXd times = recording.times.segment(begin, count);
  if (count > 1)
    part.correlation_time =
        part.in_time.correlation_frames * (times[count - 1] - times[0]) / (count - 1.0);
  part.in_space = WhitenessInSpace(difference, recording.mean_places);
  part.mean_error = MeanOver(difference, 0, static_cast<int>(count) - 1);

  const Eigen::VectorXd of_frames = RmsOfFrames(lengths);
  part.worst_span = LongestSpanAbove(
      of_frames, std::max(part.rms, kBeyondNoise * recording.LengthOf(recording.noise)),
      static_cast<int>(kLargestGap * static_cast<double>(count)));
  if (part.worst_span.above < kFewestOfSpan) part.worst_span = {};
  if (part.worst_span.first >= 0) {
    part.worst_span_error = MeanOver(difference, part.worst_span.first, part.worst_span.last);
    part.worst_span_rms = Rms(lengths.middleCols(part.worst_span.first,
                                                 part.worst_span.last - part.worst_span.first + 1));
    part.worst_span.first += first;
    part.worst_span.last += first;
  }

  // Over frames, then over markers: pooled, what differs between markers would look like a trend in
  // the motion, as those at the grip neither move nor err.
  const auto against = [&](const std::string& quantity, const Eigen::VectorXd& variable,
                           const Eigen::VectorXd& error) {
    part.against.push_back(
        {quantity, BinnedResiduals(variable, error, kBins), RankCorrelation(variable, error)});
  };
  const auto in_frames = [&](const Eigen::MatrixXd& of_points) -> Eigen::VectorXd {
    return RmsOfFrames(of_points.middleCols(begin, count));
  };
  against("time_s", times, of_frames);
  against("displacement_m", in_frames(Displacements(recording.measured)), of_frames);
  against("speed_m_per_s", in_frames(Speeds(recording.times, recording.measured)), of_frames);
  if (recording.grip_distance.size() > 0)
    against("grip_distance_m", recording.grip_distance, part.of_markers);
  return part;
}

// Fitted frames come before those held out of the same recording.
void MeasureParts(ComparedRecording* recording) {
  const int frames = static_cast<int>(recording->frames.size());
  for (int first = 0; first < frames;) {
    int last = first;
    while (last + 1 < frames && recording->fitted[last + 1] == recording->fitted[first]) ++last;
    recording->parts.push_back(MeasurePart(*recording, recording->fitted[first] != 0, first, last));
    first = last + 1;
  }
}

double MeanStep(const ComparedRecording& recording) {
  const Eigen::Index frames = recording.times.size();
  return frames > 1 ? (recording.times[frames - 1] - recording.times[0]) / (frames - 1.0)
                    : kUnknown;
}

// When each recording's motion begins: its hold's release, or its first frame.
std::vector<double> Starts(const json& configuration, const Comparison& comparison) {
  std::vector<double> starts;
  for (const ComparedRecording& recording : comparison.recordings) {
    double start = recording.times.size() > 0 ? recording.times[0] : 0;
    const json& entries = configuration.value("recordings", json::array());
    const size_t r = starts.size();
    if (r < entries.size() && entries[r].contains("hold"))
      start = entries[r].at("hold").value("release", start);
    starts.push_back(start);
  }
  return starts;
}

void ComparePairs(const json& configuration, Comparison* comparison) {
  const std::vector<double> starts = Starts(configuration, *comparison);
  for (size_t i = 0; i < comparison->recordings.size(); ++i) {
    for (size_t j = i + 1; j < comparison->recordings.size(); ++j) {
      const ComparedRecording &first = comparison->recordings[i],
                              &second = comparison->recordings[j];
      const bool same_rate =
          std::abs(MeanStep(first) / MeanStep(second) - 1) < 0.01;  // false for NaN
      // Patches are not measured along the surface, where repeats would differ too.
      if (!same_rate || first.is_scan || second.is_scan) continue;
      if (first.measured.rows() != second.measured.rows()) continue;
      const Repeatability repeatability =
          CompareRepeats(first.times, first.measured, second.times, second.measured,
                         starts[j] - starts[i], kLargestDelay);
      if (repeatability.frames > 0)
        comparison->pairs.push_back({first.name, second.name, repeatability});
    }
  }
}

}  // namespace

Comparison CompareRun(const std::filesystem::path& run) {
  RefuseOtherRuns(run);
  const std::filesystem::path stage = FinishedStage(run, "calibration");
  const CalibrationRecord record = LoadCalibration(run);
  const std::filesystem::path file = stage / "misfit.csv";
  if (!std::filesystem::exists(file)) {
    throw InputError({run.string()}, "holds a fit that could not be predicted with" +
                                         (record.message.empty() ? "" : ": " + record.message));
  }
  const CsvTable table = LoadCsv(file);
  Comparison comparison;
  comparison.noise = record.noise;
  for (size_t r = 0; r < record.recordings.size(); ++r) {
    ComparedRecording recording = ReadRecordingRows(table, static_cast<int>(r), file);
    if (recording.frames.empty())
      throw InputError({file.string()}, "has no row of recording " + record.recordings[r].name);
    recording.name = record.recordings[r].name;
    recording.noise = record.noise;
    if (const auto& scan = record.recordings[r].scan) {
      // Where a patch's points lie differs along the surface, which is no noise: its floor is that
      // of the points themselves.
      recording.is_scan = true;
      recording.noise = scan->patch_noise;
      recording.floor = scan->patch_noise * record.recordings[r].noise / record.scan_noise;
    }
    recording.mean_places = MeanPlaces(recording.measured);
    for (int m = 0; 3 * m < recording.measured.rows(); ++m)
      recording.markers.push_back(std::to_string(m));
    comparison.recordings.push_back(std::move(recording));
  }
  AddWhatTheRecordingsTell(run, record, &comparison);
  for (ComparedRecording& recording : comparison.recordings) {
    if (!recording.is_scan) MeasureNoise(&recording);
    MeasureParts(&recording);
  }
  ComparePairs(LoadManifest(run / "manifest.json").configuration, &comparison);
  return comparison;
}

}  // namespace lacuna
