// Statistics of residuals: their size over points and frames, and the noise of the measurement.
// Tests of whether residuals are noise are in whiteness.h.
//
// Vectors of m points over n frames form a 3m × n matrix: the x, y and z of a point in three
// consecutive rows, the frames in temporal order in the columns, and NaN where a point was not
// seen. Their lengths form an m × n matrix. All quantities are in SI units. A statistic that the
// data do not determine is NaN, never 0.
#ifndef LACUNA_ANALYSIS_RESIDUAL_STATISTICS_H_
#define LACUNA_ANALYSIS_RESIDUAL_STATISTICS_H_

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace lacuna {

// The value of a statistic that the data do not determine.
inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// The lengths (m × n) of vectors (3m × n); NaN if a coordinate is NaN.
Eigen::MatrixXd PointLengths(const Eigen::MatrixXd& vectors);

// The root mean square of the entries that are not NaN: over all entries, for each row (point) and
// for each column (frame). If σ is the noise of a coordinate, the lengths of noise have an rms of
// √3 σ.
double Rms(const Eigen::MatrixXd& lengths);
Eigen::VectorXd RmsOfPoints(const Eigen::MatrixXd& lengths);
Eigen::VectorXd RmsOfFrames(const Eigen::MatrixXd& lengths);

// Subtracts from each row the mean of its entries that are not NaN.
Eigen::MatrixXd Centred(Eigen::MatrixXd series);

// The standard deviation σ of the white part of measured coordinates (rows). For each row it is the
// median of the absolute second differences, divided by 0.6745 √6, and the result is the median
// over the rows. Fourth differences (with √70) are used instead if they give less, because motion
// that is fast for the frame rate contributes less to them. Noise that is correlated over frames is
// hardly included. NaN if no three consecutive frames are available.
double WhiteNoise(const Eigen::MatrixXd& positions);

// A range of consecutive frames in which all points are at rest.
struct StaticSpan {
  int first = 0, last = 0;                    // columns, both inclusive
  int measured_first = 0, measured_last = 0;  // those columns that the next three are of
  double deviation = kUnknown;    // m, scatter of a coordinate about a line in time: total noise
  double drift = kUnknown;        // m/s, rms over the points of the slope of that line
  double noise_drift = kUnknown;  // m/s, the rms slope that uncorrelated noise of `deviation` gives
};
// Measures these frames (both inclusive), whether the points rest there or not. A coordinate that
// is seen in fewer than three of them does not count; without any, the results are NaN.
StaticSpan MeasureSpan(const Eigen::VectorXd& times, const Eigen::MatrixXd& positions, int first,
                       int last);
// Finds the disjoint spans of at least `fewest` (≥ 3) frames in which the rms distance of the
// points from their positions in the first frame of the span stays within `threshold` (m). At an
// end that borders on motion, a sixth of the span is excluded from its deviation and drift.
std::vector<StaticSpan> StaticSpans(const Eigen::VectorXd& times, const Eigen::MatrixXd& positions,
                                    double threshold, int fewest);

// The distance (m × n, m) of each point from its position in the first frame in which it was seen,
// and its speed (m × n, m/s) by differences between the neighbouring frames, one-sided in the first
// and the last frame. NaN where a point was not seen in the frames that are needed.
Eigen::MatrixXd Displacements(const Eigen::MatrixXd& positions);
Eigen::MatrixXd Speeds(const Eigen::VectorXd& times, const Eigen::MatrixXd& positions);

// Bins the lengths by a variable of the same shape. The bins contain about equally many points, and
// equal values of the variable always fall into the same bin.
struct ResidualBin {
  double low = 0, high = 0, mean = 0;  // values of the variable, in its unit
  int points = 0;                      // number of entries in the bin
  double rms = 0;                      // m, rms of the lengths
};
std::vector<ResidualBin> BinnedResiduals(const Eigen::MatrixXd& variable,
                                         const Eigen::MatrixXd& lengths, int bins);

// Spearman's rank correlation, with average ranks for equal values. NaN if either variable is
// constant or if there are fewer than three pairs.
double RankCorrelation(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// The run of columns with the most values above `threshold`. Within a run, up to `largest_gap`
// consecutive values may lie below the threshold, because an oscillating error is small from time
// to time. NaN values neither count nor end a run.
struct FrameSpan {
  int first = -1, last = -1;  // −1: no value exceeds the threshold
  int above = 0;              // number of values above the threshold from first to last
};
FrameSpan LongestSpanAbove(const Eigen::VectorXd& of_frames, double threshold, int largest_gap = 0);

// The mean of the vectors e in the columns first … last and their agreement |Σ e| / Σ |e|, which is
// 1 if all vectors have the same direction and near 0 if their directions are random.
struct MeanVector {
  Eigen::Vector3d mean = Eigen::Vector3d::Constant(kUnknown);
  double agreement = kUnknown;
};
MeanVector MeanOver(const Eigen::MatrixXd& vectors, int first, int last);

// Compares two recordings of the same experiment. The second is interpolated linearly at the times
// of the first plus a delay; the delay that minimises the distance is searched for within
// ± `largest_delay` of `delay` (s). The mean difference of each row is subtracted, because markers
// may have been attached at slightly different places. Interpolation at the share s between two
// frames multiplies the variance of the second recording's noise by (1 − s)² + s², so that the
// smallest distance would be sought midway between frames. The distance is therefore divided by the
// root of the mean over the frames of (1 + (1 − s)² + s²)/2, as if the noise were that of two
// measurements.
struct Repeatability {
  int frames = 0;              // frames of the first that the second covers; 0: no result
  double delay = kUnknown;     // s, how much later the same motion is in the second
  double distance = kUnknown;  // m, rms between the two; the noise of each is 1/√2 of it
};
Repeatability CompareRepeats(const Eigen::VectorXd& first_times, const Eigen::MatrixXd& first,
                             const Eigen::VectorXd& second_times, const Eigen::MatrixXd& second,
                             double delay, double largest_delay);

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_RESIDUAL_STATISTICS_H_
