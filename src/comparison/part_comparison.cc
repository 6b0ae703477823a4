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

// The errors of one range of frames. Matrices have the columns of that range only.
struct RangeErrors {
  Eigen::MatrixXd difference;  // 3m × n, m
  Eigen::MatrixXd lengths;     // m × n, m
  Eigen::MatrixXd over_noise;  // m × n: LengthsOverNoise()
  // The components of the errors of m points, without their mean over the frames, over the σ of the
  // point: 3m × n for markers; m × n for patches, whose difference is one number times the normal.
  Eigen::MatrixXd components;
};

RangeErrors ErrorsIn(const RecordedResiduals& residuals, const FrameRange& range,
                     const ComparedRecording& recording) {
  const auto in_range = [&](const Eigen::MatrixXd& all) -> Eigen::MatrixXd {
    return all.middleCols(range.first, range.Count());
  };
  RangeErrors errors;
  errors.difference = in_range(residuals.difference);
  errors.lengths = PointLengths(errors.difference);
  errors.over_noise = in_range(LengthsOverNoise(residuals, recording));
  errors.components =
      Centred(recording.is_scan ? in_range(residuals.along_normal) : errors.difference);
  const Eigen::MatrixXd sigma = in_range(residuals.sigma);
  const Eigen::Index each = errors.components.rows() / sigma.rows();
  for (Eigen::Index row = 0; row < errors.components.rows(); ++row)
    errors.components.row(row).array() /= sigma.row(row / each).array();
  return errors;
}

ErrorSize MeasureError(const RangeErrors& errors, const Eigen::VectorXd& times,
                       const ComparedRecording& recording) {
  const Eigen::MatrixXd &difference = errors.difference, &lengths = errors.lengths;
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
  error.rms_over_sigma = Rms(errors.over_noise);
  const double floor = recording.noise_floor.floor;
  if (floor > 0) error.rms_over_floor = error.rms_over_sigma * recording.noise / floor;
  error.changing = Rms(PointLengths(Centred(difference)));
  error.steady = std::sqrt(std::max(0.0, error.rms * error.rms - error.changing * error.changing));
  error.mean_difference =
      MeanDifferenceOver(difference, 0, static_cast<int>(difference.cols()) - 1);
  return error;
}

TimeCorrelation CorrelationInTime(const Eigen::MatrixXd& components, const Eigen::VectorXd& times) {
  const TimeWhiteness whiteness = WhitenessInTime(components);
  TimeCorrelation in_time{whiteness.lags, whiteness.statistic, whiteness.lag_one, kUnknown,
                          whiteness.p_value};
  const Eigen::Index count = times.size();
  if (count > 1)
    in_time.time = whiteness.correlation_frames * (times[count - 1] - times[0]) / (count - 1.0);
  return in_time;
}

SpaceCorrelation CorrelationInSpace(const Eigen::MatrixXd& components,
                                    const Eigen::Matrix3Xd& places, bool with_pairs) {
  const SpaceWhiteness whiteness = WhitenessInSpace(components, places);
  SpaceCorrelation in_space{
      whiteness.mean_correlation, whiteness.correlation_length, whiteness.p_value, {}};
  if (!with_pairs) return in_space;
  for (const PointPair& pair : whiteness.pairs)
    in_space.pairs.push_back({pair.first, pair.second, pair.distance, pair.correlation});
  return in_space;
}

// `threshold`: of the rms of a frame's errors over the noise.
std::optional<WorstPeriod> FindWorstPeriod(const RangeErrors& errors, double threshold,
                                           const RecordedResiduals& residuals, int first_column) {
  const FrameSpan span =
      LongestSpanAbove(RmsOfFrames(errors.over_noise), threshold,
                       static_cast<int>(kLargestGap * static_cast<double>(errors.lengths.cols())));
  if (span.first < 0 || span.above < kFewestFramesOfPeriod) return std::nullopt;
  const int first = first_column + span.first, last = first_column + span.last;
  const int frames = last - first + 1;
  return WorstPeriod{residuals.frames[first],
                     residuals.frames[last],
                     frames,
                     residuals.times[first],
                     residuals.times[last],
                     Rms(errors.lengths.middleCols(span.first, frames)),
                     MeanDifferenceOver(errors.difference, span.first, span.last)};
}

// The trends over frames use the rms over the points of each frame, and the trend with the
// distance from the grip uses the rms over the frames of each point. If frames and points were
// pooled, differences between points would look like a trend in time, because points near the grip
// have small displacements and small errors.
std::vector<ErrorTrend> Trends(const RecordedResiduals& residuals, const FrameRange& range,
                               const ComparedRecording& recording, const RangeErrors& errors) {
  const Eigen::VectorXd frame_rms = RmsOfFrames(errors.lengths);
  const Eigen::VectorXd over_noise = RmsOfFrames(errors.over_noise);
  const auto rms_of_frames = [&](const Eigen::MatrixXd& of_points) -> Eigen::VectorXd {
    return RmsOfFrames(of_points.middleCols(range.first, range.Count()));
  };
  std::vector<ErrorTrend> trends{
      TrendWith("time_s", residuals.times.segment(range.first, range.Count()), frame_rms,
                over_noise),
      TrendWith("displacement_m", rms_of_frames(Displacements(residuals.measured)), frame_rms,
                over_noise),
      TrendWith("speed_m_per_s", rms_of_frames(Speeds(residuals.times, residuals.measured)),
                frame_rms, over_noise)};
  if (recording.grip_distance.size() > 0)
    trends.push_back(TrendWith("grip_distance_m", recording.grip_distance,
                               RmsOfPoints(errors.lengths), RmsOfPoints(errors.over_noise)));
  return trends;
}

}  // namespace

Eigen::MatrixXd LengthsOverNoise(const RecordedResiduals& residuals,
                                 const ComparedRecording& recording) {
  return PointLengths(residuals.difference).array() /
         residuals.sigma.unaryExpr([&](double s) { return recording.RmsOfNoise(s); }).array();
}

Eigen::Matrix3Xd MeanPlaces(const RecordedResiduals& residuals) {
  const int last = static_cast<int>(residuals.measured.cols()) - 1;
  Eigen::Matrix3Xd places(3, residuals.PointCount());
  for (Eigen::Index m = 0; m < places.cols(); ++m)
    places.col(m) = MeanOver(residuals.measured.middleRows<3>(3 * m), 0, last).mean;
  return places;
}

ErrorTrend TrendWith(const std::string& quantity, const Eigen::VectorXd& values,
                     const Eigen::VectorXd& error, const Eigen::VectorXd& over_noise) {
  ErrorTrend trend{quantity, RankCorrelation(values, error), {}};
  // Both have the same bins, because they are known in the same frames or at the same points.
  const std::vector<ResidualBin> bins = BinnedResiduals(values, error, kBins),
                                 multiples = BinnedResiduals(values, over_noise, kBins);
  for (size_t k = 0; k < bins.size(); ++k)
    trend.bins.push_back(
        {bins[k].low, bins[k].high, bins[k].mean, bins[k].points, bins[k].rms, multiples[k].rms});
  return trend;
}

ComparedPart ComparePart(const RecordedResiduals& residuals, const FrameRange& range,
                         const ComparedRecording& recording) {
  const RangeErrors errors = ErrorsIn(residuals, range, recording);
  const Eigen::VectorXd times = residuals.times.segment(range.first, range.Count());
  ComparedPart part;
  part.fitted = range.fitted;
  part.frames = range.Count();
  part.from = residuals.times[range.first];
  part.to = residuals.times[range.last];
  part.error = MeasureError(errors, times, recording);
  part.point_rms = RmsOfPoints(errors.lengths);
  for (int m = 0; m < part.point_rms.size(); ++m)
    if (!std::isnan(part.point_rms[m]) &&
        (part.worst_point < 0 || part.point_rms[m] > part.point_rms[part.worst_point]))
      part.worst_point = m;
  part.in_time = CorrelationInTime(errors.components, times);
  // A scan has too many pairs of patches to be listed.
  part.in_space = CorrelationInSpace(errors.components, MeanPlaces(residuals), !recording.is_scan);
  part.worst_period = FindWorstPeriod(errors, std::max(part.error.rms_over_sigma, kBeyondNoise),
                                      residuals, range.first);
  part.trends = Trends(residuals, range, recording, errors);
  return part;
}

}  // namespace lacuna
