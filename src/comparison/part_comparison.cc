#include "comparison/part_comparison.h"

#include <algorithm>
#include <cmath>

#include "analysis/residual_statistics.h"
#include "analysis/whiteness.h"

namespace lacuna {
namespace {

constexpr int kBins = 10;
constexpr int kFewestFramesOfPeriod = 3;  // smallest number of bad frames that form a period
constexpr double kLargestGap = 0.05;      // share of the frames that may be good within a period

MeanDifference MeanDifferenceOver(const Eigen::MatrixXd& difference, int first, int last) {
  const MeanVector mean = MeanOver(difference, first, last);
  return {mean.mean, mean.agreement};
}

// `difference` and `lengths` contain only the columns of the range.
ErrorSize MeasureError(const Eigen::MatrixXd& difference, const Eigen::MatrixXd& lengths,
                       const Eigen::VectorXd& times, const ComparedRecording& recording) {
  ErrorSize error;
  error.rms = Rms(lengths);
  for (Eigen::Index f = 0; f < lengths.cols(); ++f) {
    for (Eigen::Index m = 0; m < lengths.rows(); ++m) {
      if (std::isnan(lengths(m, f))) continue;
      ++error.points;
      if (lengths(m, f) <= error.largest) continue;
      error.largest = lengths(m, f);
      error.largest_point = static_cast<int>(m);
      error.largest_time = times[f];
    }
  }
  error.rms_over_sigma = error.rms / recording.RmsOfNoise(recording.noise);
  const double floor = recording.noise_floor.floor;
  if (floor > 0) error.rms_over_floor = error.rms / recording.RmsOfNoise(floor);
  error.changing = Rms(PointLengths(Centred(difference)));
  error.steady = std::sqrt(std::max(0.0, error.rms * error.rms - error.changing * error.changing));
  error.mean_difference =
      MeanDifferenceOver(difference, 0, static_cast<int>(difference.cols()) - 1);
  return error;
}

TimeCorrelation CorrelationInTime(const Eigen::MatrixXd& difference, const Eigen::VectorXd& times) {
  const TimeWhiteness whiteness = WhitenessInTime(difference);
  TimeCorrelation in_time{whiteness.lags, whiteness.statistic, whiteness.lag_one, kUnknown,
                          whiteness.p_value};
  const Eigen::Index count = times.size();
  if (count > 1)
    in_time.time = whiteness.correlation_frames * (times[count - 1] - times[0]) / (count - 1.0);
  return in_time;
}

SpaceCorrelation CorrelationInSpace(const Eigen::MatrixXd& difference,
                                    const Eigen::Matrix3Xd& places, bool with_pairs) {
  const SpaceWhiteness whiteness = WhitenessInSpace(difference, places);
  SpaceCorrelation in_space{
      whiteness.mean_correlation, whiteness.correlation_length, whiteness.p_value, {}};
  if (!with_pairs) return in_space;
  for (const PointPair& pair : whiteness.pairs)
    in_space.pairs.push_back({pair.first, pair.second, pair.distance, pair.correlation});
  return in_space;
}

std::optional<WorstPeriod> FindWorstPeriod(const Eigen::MatrixXd& difference,
                                           const Eigen::MatrixXd& lengths, double threshold,
                                           const RecordedResiduals& residuals, int first_column) {
  const FrameSpan span =
      LongestSpanAbove(RmsOfFrames(lengths), threshold,
                       static_cast<int>(kLargestGap * static_cast<double>(lengths.cols())));
  if (span.first < 0 || span.above < kFewestFramesOfPeriod) return std::nullopt;
  const int first = first_column + span.first, last = first_column + span.last;
  const int frames = last - first + 1;
  return WorstPeriod{residuals.frames[first],
                     residuals.frames[last],
                     frames,
                     residuals.times[first],
                     residuals.times[last],
                     Rms(lengths.middleCols(span.first, frames)),
                     MeanDifferenceOver(difference, span.first, span.last)};
}

// The trends over frames use the rms over the points of each frame, and the trend with the
// distance from the grip uses the rms over the frames of each point. If frames and points were
// pooled, differences between points would look like a trend in time, because points near the grip
// have small displacements and small errors.
std::vector<ErrorTrend> Trends(const RecordedResiduals& residuals, const FrameRange& range,
                               const ComparedRecording& recording, const Eigen::MatrixXd& lengths,
                               const Eigen::VectorXd& point_rms) {
  const Eigen::VectorXd frame_rms = RmsOfFrames(lengths);
  const auto rms_of_frames = [&](const Eigen::MatrixXd& of_points) -> Eigen::VectorXd {
    return RmsOfFrames(of_points.middleCols(range.first, range.Count()));
  };
  std::vector<ErrorTrend> trends{
      TrendWith("time_s", residuals.times.segment(range.first, range.Count()), frame_rms),
      TrendWith("displacement_m", rms_of_frames(Displacements(residuals.measured)), frame_rms),
      TrendWith("speed_m_per_s", rms_of_frames(Speeds(residuals.times, residuals.measured)),
                frame_rms)};
  if (recording.grip_distance.size() > 0)
    trends.push_back(TrendWith("grip_distance_m", recording.grip_distance, point_rms));
  return trends;
}

}  // namespace

Eigen::Matrix3Xd MeanPlaces(const RecordedResiduals& residuals) {
  const int last = static_cast<int>(residuals.measured.cols()) - 1;
  Eigen::Matrix3Xd places(3, residuals.PointCount());
  for (Eigen::Index m = 0; m < places.cols(); ++m)
    places.col(m) = MeanOver(residuals.measured.middleRows<3>(3 * m), 0, last).mean;
  return places;
}

ErrorTrend TrendWith(const std::string& quantity, const Eigen::VectorXd& values,
                     const Eigen::VectorXd& error) {
  ErrorTrend trend{quantity, RankCorrelation(values, error), {}};
  for (const ResidualBin& bin : BinnedResiduals(values, error, kBins))
    trend.bins.push_back({bin.low, bin.high, bin.mean, bin.points, bin.rms});
  return trend;
}

ComparedPart ComparePart(const RecordedResiduals& residuals, const FrameRange& range,
                         const ComparedRecording& recording) {
  const Eigen::MatrixXd difference = residuals.difference.middleCols(range.first, range.Count());
  const Eigen::MatrixXd lengths = PointLengths(difference);
  const Eigen::VectorXd times = residuals.times.segment(range.first, range.Count());
  ComparedPart part;
  part.fitted = range.fitted;
  part.frames = range.Count();
  part.from = residuals.times[range.first];
  part.to = residuals.times[range.last];
  part.error = MeasureError(difference, lengths, times, recording);
  part.point_rms = RmsOfPoints(lengths);
  for (int m = 0; m < part.point_rms.size(); ++m)
    if (!std::isnan(part.point_rms[m]) &&
        (part.worst_point < 0 || part.point_rms[m] > part.point_rms[part.worst_point]))
      part.worst_point = m;
  part.in_time = CorrelationInTime(difference, times);
  // A scan has too many pairs of patches to be listed.
  part.in_space = CorrelationInSpace(difference, MeanPlaces(residuals), !recording.is_scan);
  const double threshold =
      std::max(part.error.rms, kBeyondNoise * recording.RmsOfNoise(recording.noise));
  part.worst_period = FindWorstPeriod(difference, lengths, threshold, residuals, range.first);
  part.trends = Trends(residuals, range, recording, lengths, part.point_rms);
  return part;
}

}  // namespace lacuna
