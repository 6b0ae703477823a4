#include "comparison/run_comparison.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "analysis/residual_statistics.h"
#include "calibration/calibration_run.h"
#include "comparison/noise_floor.h"
#include "comparison/part_comparison.h"
#include "comparison/recording_details.h"
#include "core/error.h"
#include "core/hash.h"
#include "record/csv_table.h"
#include "record/run_directory.h"

namespace lacuna {
namespace {

using nlohmann::json;

// s; largest delay that is sought between two repeats after alignment at their releases.
constexpr double kLargestDelay = 0.1;
constexpr double kSameRate = 0.01;  // largest relative difference of equal frame rates
// Points that only their numbers identify are at the same places if the distances of their first
// positions have an rms of at most so many times that of noise. Larger: points on grids that were
// set up anew may be taken for the same; smaller: repeats that start a little apart are not
// compared.
constexpr double kSamePlaces = 2;

double MeanTimeStep(const RecordedResiduals& residuals) {
  const Eigen::Index frames = residuals.times.size();
  return frames > 1 ? (residuals.times[frames - 1] - residuals.times[0]) / (frames - 1.0)
                    : kUnknown;
}

// The time, s, at which the motion of each recording begins: the release of its hold or, without a
// hold, its first frame.
std::vector<double> StartTimes(const json& configuration,
                               const std::vector<RecordedResiduals>& residuals) {
  std::vector<double> starts;
  for (const RecordedResiduals& recording : residuals) {
    double start = recording.times.size() > 0 ? recording.times[0] : 0;
    const json& entries = configuration.value("recordings", json::array());
    const size_t r = starts.size();
    if (r < entries.size() && entries[r].contains("hold"))
      start = entries[r].at("hold").value("release", start);
    starts.push_back(start);
  }
  return starts;
}

// The points with the same names: their numbers in `first` and in `second`.
std::vector<std::pair<int, int>> CommonPoints(const ComparedRecording& first,
                                              const ComparedRecording& second) {
  std::vector<std::pair<int, int>> common;
  for (size_t i = 0; i < first.point_names.size(); ++i) {
    const auto found =
        std::find(second.point_names.begin(), second.point_names.end(), first.point_names[i]);
    if (found != second.point_names.end())
      common.emplace_back(static_cast<int>(i),
                          static_cast<int>(found - second.point_names.begin()));
  }
  return common;
}

// The rows of these points.
Eigen::MatrixXd TracksOf(const std::vector<int>& points, const Eigen::MatrixXd& measured) {
  Eigen::MatrixXd tracks(3 * static_cast<Eigen::Index>(points.size()), measured.cols());
  for (size_t k = 0; k < points.size(); ++k)
    tracks.middleRows<3>(3 * static_cast<Eigen::Index>(k)) = measured.middleRows<3>(3 * points[k]);
  return tracks;
}

// Compares recordings that may be repeats of each other, which have the same frame rate and markers
// of the same names. Points that are not known to be markers (`are_markers`) have to start at the
// same places, because their names are only numbers. Patches of scans are not compared, because
// they are not measured along the surface.
void ComparePairs(const json& configuration, const std::vector<char>& are_markers,
                  Comparison* comparison) {
  const std::vector<double> starts = StartTimes(configuration, comparison->residuals);
  const std::vector<ComparedRecording>& recordings = comparison->record.recordings;
  for (size_t i = 0; i < recordings.size(); ++i) {
    for (size_t j = i + 1; j < recordings.size(); ++j) {
      const RecordedResiduals &first = comparison->residuals[i], &second = comparison->residuals[j];
      const bool same_rate =
          std::abs(MeanTimeStep(first) / MeanTimeStep(second) - 1) < kSameRate;  // false for NaN
      if (!same_rate || recordings[i].is_scan || recordings[j].is_scan) continue;
      std::vector<int> in_first, in_second;
      for (const auto& [a, b] : CommonPoints(recordings[i], recordings[j])) {
        in_first.push_back(a);
        in_second.push_back(b);
      }
      if (in_first.empty()) continue;
      const Eigen::MatrixXd of_first = TracksOf(in_first, first.measured),
                            of_second = TracksOf(in_second, second.measured);
      const double apart = Rms(PointLengths(of_second.col(0) - of_first.col(0)));
      // The distance between two measurements of one place has √2 times the rms of the noise.
      const double noise = std::sqrt(2.0) * recordings[i].RmsOfNoise(recordings[i].noise);
      if (!(are_markers[i] && are_markers[j]) && !(apart <= kSamePlaces * noise)) continue;
      const Repeatability repeatability = CompareRepeats(
          first.times, of_first, second.times, of_second, starts[j] - starts[i], kLargestDelay);
      if (repeatability.frames > 0)
        comparison->record.pairs.push_back({recordings[i].name, recordings[j].name,
                                            repeatability.frames, repeatability.delay,
                                            repeatability.distance});
    }
  }
}

ComparedRecording DescribeRecording(const FittedRecording& fitted, const CalibrationRecord& record,
                                    int points) {
  ComparedRecording recording;
  recording.name = fitted.name;
  recording.noise = record.noise;
  recording.reactions = fitted.reactions;
  if (fitted.scan) {
    // The measured places of a patch also scatter along the surface, which is not noise. The noise
    // floor of a patch is therefore derived from the noise of its points.
    recording.is_scan = true;
    recording.noise = fitted.scan->patch_noise;
    recording.noise_floor.floor = fitted.scan->patch_noise * fitted.noise / record.scan_noise;
  }
  for (int m = 0; m < points; ++m) recording.point_names.push_back(std::to_string(m));
  return recording;
}

}  // namespace

Comparison CompareRun(const std::filesystem::path& run) {
  RefuseOtherRuns(run);
  const std::filesystem::path stage = FinishedStage(run, "calibration");
  const CalibrationRecord record = ReadCalibration(run);
  const std::filesystem::path file = stage / "misfit.csv";
  if (!std::filesystem::exists(file)) {
    throw InputError({run.string()}, "holds a fit whose model could not be simulated" +
                                         (record.message.empty() ? "" : ": " + record.message));
  }
  const CsvTable table = ReadCsv(file);
  Comparison comparison;
  comparison.record.fit = HashFile(stage / "calibration.json");
  comparison.record.noise = record.noise;
  for (size_t r = 0; r < record.recordings.size(); ++r) {
    RecordedResiduals residuals = ReadResiduals(table, static_cast<int>(r), file);
    if (residuals.frames.empty())
      throw InputError({file.string()}, "has no row for recording " + record.recordings[r].name);
    if (residuals.sigma.size() == 0)
      throw InputError({file.string()},
                       "was written by an earlier version; run `lacuna fit` again");
    comparison.record.recordings.push_back(
        DescribeRecording(record.recordings[r], record, residuals.PointCount()));
    comparison.residuals.push_back(std::move(residuals));
  }
  comparison.forces.resize(record.recordings.size());
  const std::vector<char> are_markers = AddRecordingDetails(run, record, &comparison);
  for (size_t r = 0; r < comparison.residuals.size(); ++r) {
    const RecordedResiduals& residuals = comparison.residuals[r];
    ComparedRecording& recording = comparison.record.recordings[r];
    if (!recording.is_scan) recording.noise_floor = MeasureNoiseFloor(residuals, recording.noise);
    for (const FrameRange& range : FittedAndHeldOutRanges(residuals)) {
      ComparedPart part = ComparePart(residuals, range, recording);
      const FittedRecording& fitted = record.recordings[r];
      const MisfitMeasure& measure = part.fitted ? fitted.in_fit : fitted.held_out;
      if (measure.points > 0) part.rms_at_measured_places = measure.rms_at_measured_places;
      recording.parts.push_back(std::move(part));
    }
  }
  ComparePairs(ReadManifest(run / "manifest.json").configuration, are_markers, &comparison);
  return comparison;
}

}  // namespace lacuna
