// What the residuals of a prediction say: how large they are and where, and how much noise the
// measurement itself holds. Whether they are noise: whiteness.h.
//
// Vectors of m points over n frames are a matrix 3m × n: a point's x, y, z in three rows, frames in
// time order in the columns, NaN where a point was not seen. Lengths of such vectors are m × n.
// What cannot be told from the data given is NaN, never 0. All SI.
#ifndef LACUNA_ANALYSIS_RESIDUAL_STATISTICS_H_
#define LACUNA_ANALYSIS_RESIDUAL_STATISTICS_H_

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace lacuna {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// m × n, NaN where a coordinate is.
Eigen::MatrixXd PointLengths(const Eigen::MatrixXd& vectors);

// Root mean square of the entries that are not NaN: of all, of each row (point), of each column
// (frame). With σ the noise of a coordinate, a length of noise alone has √3 σ.
double Rms(const Eigen::MatrixXd& lengths);
Eigen::VectorXd RmsOfPoints(const Eigen::MatrixXd& lengths);
Eigen::VectorXd RmsOfFrames(const Eigen::MatrixXd& lengths);

// Rows minus the mean of what was seen of each; NaN stays.
Eigen::MatrixXd Centred(Eigen::MatrixXd series);

// σ of the white part of measured coordinates (rows): the median of |second differences| over
// 0.6745 √6, of each row, then the median of the rows; or the same of fourth differences (√70) where
// that is less, as they see less of a motion that is quick for the frame rate. Noise that is
// correlated over frames hardly shows. NaN without three frames in a row.
double WhiteNoise(const Eigen::MatrixXd& positions);

// Frames over which the points, measured at `positions`, rest.
struct StaticSpan {
  int first = 0, last = 0;      // columns
  double deviation = kUnknown;  // m, of a coordinate from a straight line in time: all of the noise
  double drift = kUnknown;      // m/s, rms over the points of that line's slope
};
// The spans, one after the other, of at least `fewest` (≥ 3) frames in which the rms over the
// points of the distance from the span's first frame stays within `threshold`. Where a span borders
// on motion the sixth of it next to that is not measured.
std::vector<StaticSpan> StaticSpans(const Eigen::VectorXd& times, const Eigen::MatrixXd& positions,
                                    double threshold, int fewest);

// m × n: how far from the point's place in the first frame that saw it; and how fast, from the
// frames before and after (at the ends one of them), NaN where these did not see it.
Eigen::MatrixXd Displacements(const Eigen::MatrixXd& positions);
Eigen::MatrixXd Speeds(const Eigen::VectorXd& times, const Eigen::MatrixXd& positions);

// Lengths against a variable, of the same shape: bins with about as many points each, equal values
// of the variable never apart.
struct ResidualBin {
  double low = 0, high = 0, mean = 0;  // of the variable
  int points = 0;
  double rms = 0;
};
std::vector<ResidualBin> BinnedResiduals(const Eigen::MatrixXd& variable,
                                         const Eigen::MatrixXd& lengths, int bins);

// Spearman's: the correlation of the ranks, equal values sharing theirs. NaN where either is
// constant or fewer than three pairs are there.
double RankCorrelation(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// The run with the most columns above `threshold`, of those whose columns above it lie no more than
// `largest_gap` columns below it apart (an error that swings is small now and then). Columns that
// are NaN neither count nor break it.
struct FrameSpan {
  int first = -1, last = -1;  // −1: there is none
  int above = 0;              // columns above the threshold, from first to last
};
FrameSpan LongestSpanAbove(const Eigen::VectorXd& of_frames, double threshold, int largest_gap = 0);

// Mean of the vectors in columns first..last, and how much they agree: |Σ e| / Σ |e|, 1 where all
// point the same way, about 0 where they point everywhere.
struct MeanVector {
  Eigen::Vector3d mean = Eigen::Vector3d::Constant(kUnknown);
  double agreement = kUnknown;
};
MeanVector MeanOver(const Eigen::MatrixXd& vectors, int first, int last);

// How well two recordings of the same thing repeat each other: the second is read at the first's
// times plus a delay, linearly between its frames, and the delay is the one, within
// ± `largest_delay` of `delay`, at which they are nearest. Each row's mean difference (the same
// marker stuck on elsewhere) is taken away.
struct Repeatability {
  int frames = 0;              // of the first that the second covers at that delay; 0: not known
  double delay = kUnknown;     // s
  double distance = kUnknown;  // m, rms between the two; of one from the truth 1/√2 of it
};
Repeatability CompareRepeats(const Eigen::VectorXd& first_times, const Eigen::MatrixXd& first,
                             const Eigen::VectorXd& second_times, const Eigen::MatrixXd& second,
                             double delay, double largest_delay);

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_RESIDUAL_STATISTICS_H_
