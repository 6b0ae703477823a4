#include "experiment/recording_scatter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/track_scatter.h"
#include "core/median.h"
#include "experiment/frame_states.h"
#include "experiment/tracked_points.h"
#include "scan/surface_scatter.h"

namespace lacuna {
namespace {

// So many tracks determine the noise well, also that of the one that scatters most.
constexpr Eigen::Index kMostTracks = 100;

// At most kMostTracks of `count` points, evenly chosen.
std::vector<Eigen::Index> SomeTracks(Eigen::Index count) {
  const Eigen::Index used = std::min(count, kMostTracks);
  std::vector<Eigen::Index> chosen;
  for (Eigen::Index k = 0; k < used; ++k) chosen.push_back(k * count / used);
  return chosen;
}

// The frames in which any marker was seen.
std::vector<int> FramesWithMarkers(const Markers& markers) {
  std::vector<int> frames;
  for (size_t f = 0; f < markers.positions.size(); ++f)
    if (!markers.positions[f].array().isNaN().all()) frames.push_back(static_cast<int>(f));
  return frames;
}

// Each n-th frame from the first to the last of `seen`, with the largest n that leaves none of them
// out: an experiment may use every second frame only, and no marker is seen in the others.
std::vector<int> WithGaps(const std::vector<int>& seen) {
  int step = 0;
  for (const int frame : seen) step = std::gcd(step, frame - seen.front());
  std::vector<int> frames;
  for (int frame = seen.front(); frame <= seen.back(); frame += std::max(1, step))
    frames.push_back(frame);
  return frames;
}

// The places of the chosen markers in each frame (3 × chosen × frames, m).
Eigen::MatrixXd TracksOf(const Markers& markers, const std::vector<Eigen::Index>& chosen,
                         const std::vector<int>& frames) {
  Eigen::MatrixXd tracks(3 * static_cast<Eigen::Index>(chosen.size()),
                         static_cast<Eigen::Index>(frames.size()));
  for (size_t f = 0; f < frames.size(); ++f) {
    const Eigen::Matrix3Xd places = markers.positions[frames[f]](Eigen::all, chosen);
    tracks.col(static_cast<Eigen::Index>(f)) = places.reshaped();
  }
  return tracks;
}

}  // namespace

void ScatterSurvey::Add(const Frame& frame) {
  if (IsScan(recording_)) {
    AddSurface(frame);
  } else if (recording_.markers.positions.empty()) {
    const Eigen::Matrix3Xd by_row = PointsByRow(frame);
    tracked_frames_.push_back(frame.index);
    places_.push_back(by_row(Eigen::all, SomeTracks(by_row.cols())));
  }
}

void ScatterSurvey::AddSurface(const Frame& frame) {
  const SurfaceScatter scatter = MeasureSurfaceScatter(frame.cloud.points, frame.sensors.seen_by);
  if (std::isnan(scatter.deviation)) return;
  const bool is_mesh = frame.triangles.cols() > 0;
  frames_.push_back(frame.index);
  deviations_.push_back(scatter.deviation);
  is_upper_bound_.push_back(scatter.is_upper_bound);
  spacings_.push_back(is_mesh ? 0 : scatter.spacing);
  outlier_shares_.push_back(scatter.outlier_share);
  farthest_ = std::max(farthest_, scatter.farthest);
}

RecordingScatter ScatterSurvey::Result() const {
  return IsScan(recording_) ? OfSurfaces() : OfTracks();
}

RecordingScatter ScatterSurvey::OfSurfaces() const {
  RecordingScatter result;
  result.is_of_surface = true;
  if (frames_.empty()) return result;
  result.typical = Median(deviations_);
  const auto bounds = std::count(is_upper_bound_.begin(), is_upper_bound_.end(), true);
  result.is_upper_bound = 2 * bounds > static_cast<std::ptrdiff_t>(frames_.size());
  const auto largest = std::max_element(deviations_.begin(), deviations_.end());
  result.largest = *largest;
  result.largest_in = fmt::format("frame {}", frames_[largest - deviations_.begin()]);
  result.spacing = Median(spacings_);
  result.outlier_share = std::accumulate(outlier_shares_.begin(), outlier_shares_.end(), 0.0) /
                         static_cast<double>(frames_.size());
  const auto worst = std::max_element(outlier_shares_.begin(), outlier_shares_.end());
  result.worst_share = *worst;
  if (*worst > 0) result.worst_frame = frames_[worst - outlier_shares_.begin()];
  result.farthest = farthest_;
  return result;
}

RecordingScatter ScatterSurvey::OfTracks() const {
  const Markers& markers = recording_.markers;
  const bool has_names = !markers.positions.empty();
  const std::vector<int> seen = has_names ? FramesWithMarkers(markers) : tracked_frames_;
  RecordingScatter result;
  if (seen.empty()) return result;
  const std::vector<int> frames = has_names ? WithGaps(seen) : seen;
  const Eigen::Index in_all = has_names ? markers.places.cols() : recording_.row_count;
  const std::vector<Eigen::Index> chosen = SomeTracks(in_all);
  const auto count = static_cast<Eigen::Index>(chosen.size());
  Eigen::MatrixXd tracks(3 * count, static_cast<Eigen::Index>(frames.size()));
  Eigen::VectorXd factors = Eigen::VectorXd::Ones(count);
  if (has_names) {
    tracks = TracksOf(markers, chosen, frames);
    factors = TrackFactors(markers, seen)(chosen);
  } else {
    for (size_t f = 0; f < places_.size(); ++f)
      tracks.col(static_cast<Eigen::Index>(f)) = places_[f].reshaped();
  }
  // Tracks that all have the same noise.
  Eigen::MatrixXd scaled = tracks;
  for (Eigen::Index m = 0; m < count; ++m) scaled.middleRows<3>(3 * m) *= factors[m];
  Eigen::VectorXd times(static_cast<Eigen::Index>(frames.size()));
  for (size_t f = 0; f < frames.size(); ++f)
    times[static_cast<Eigen::Index>(f)] = recording_.times[frames[f]];
  const TrackNoise noise = EstimateTrackNoise(times, scaled);
  result.typical = noise.deviation;
  result.is_upper_bound = !noise.is_at_rest;
  if (std::isnan(noise.deviation)) return result;
  for (Eigen::Index m = 0; m < count; ++m) {
    // In the frames in which all points rest: a single point may be slow while it moves.
    const Eigen::MatrixXd track = tracks.middleRows<3>(3 * m);
    const double own = noise.is_at_rest ? MeasureSpan(times, track, noise.rest.measured_first,
                                                      noise.rest.measured_last)
                                              .deviation
                                        : WhiteNoise(track);
    if (!(own > result.largest)) continue;
    result.largest = own;
    result.largest_in =
        fmt::format("{} {}", HasTrackedPoints(recording_) ? "point" : "marker",
                    has_names ? markers.names[chosen[m]] : fmt::format("p{}", chosen[m]));
  }
  const TrackOutliers outliers =
      FindTrackOutliers(times, tracks, noise.deviation * factors.cwiseInverse());
  result.outlier_share = outliers.share;
  result.farthest = outliers.farthest;
  if (outliers.worst_frame < 0) return result;
  result.worst_frame = frames[outliers.worst_frame];
  result.worst_share = outliers.in_worst_frame / static_cast<double>(count);
  return result;
}

}  // namespace lacuna
