// Noise of a measurement that is repeated over frames, and its whitening.
//
// The noise of each series, for example of one coordinate of one marker, is modelled as
//   e ~ N(0, σ² R + s² 1 1ᵀ),   R_ij = exp(−|t_i − t_j|/τ).
// Its first part is correlated over a time τ (an Ornstein–Uhlenbeck process; white for τ = 0). The
// second part is an offset common to all frames, since the position of a marker on the object is
// known only to within s. The offset moves with the material: if the deformation gradient F_t at
// the marker is given, the three coordinates have the covariance s² F_t F_uᵀ between the frames t
// and u. A marker that several recordings show has one offset in all of them, so that t and u may
// be frames of different recordings, between which the first part is 0. A value that is the mean of
// n measurements has σ/√n in place of σ.
//
// The rows of a recording are ordered by frame, with all series of a frame together.
#ifndef LACUNA_ANALYSIS_SERIES_NOISE_H_
#define LACUNA_ANALYSIS_SERIES_NOISE_H_

#include <Eigen/Core>
#include <vector>

namespace lacuna {

struct SeriesLayout {
  int series = 0;             // number of series
  std::vector<double> times;  // s, times of the frames, ascending
  // series × frames: n of each mean, which need not be whole; 0 where nothing was observed.
  std::vector<double> count;
  // (series/3) × frames: F at the point whose coordinates are three consecutive series. Empty: the
  // offset is constant and the series are independent.
  std::vector<Eigen::Matrix3d> deformation;
  // One number for each offset, i.e. for each point with `deformation`, or for each series without.
  // Recordings in which the same number stands have that offset in common. Empty: none of the
  // offsets is that of another recording.
  std::vector<int> offset_ids = {};

  Eigen::Index Rows() const {
    return static_cast<Eigen::Index>(series) * static_cast<Eigen::Index>(times.size());
  }
  // Series that share an offset: three coordinates that deform together, or one.
  int SeriesPerOffset() const { return deformation.empty() ? 1 : 3; }
};

struct SeriesNoise {
  double deviation = 1;         // σ, in the unit of the rows
  double correlation_time = 0;  // τ, s
  double offset_deviation = 0;  // s
};

// Whitens each column, i.e. applies an inverse square root of the covariance. Rows that were not
// observed or whose frame is not selected by `frames` (one flag per frame; empty: all) become 0,
// and the other rows are whitened as if those frames did not exist. CHECKs the sizes and that σ >
// 0.
Eigen::MatrixXd Whitened(const Eigen::MatrixXd& rows, const SeriesLayout& layout,
                         const SeriesNoise& noise, const std::vector<char>& frames = {});

// One of several recordings whose rows are whitened together. The layout and the frames must
// outlive it.
struct NoisyRecording {
  Eigen::Index first_row = 0;
  const SeriesLayout* layout = nullptr;
  SeriesNoise noise;
  const std::vector<char>* frames = nullptr;  // as above; null: all
};
// The same for the rows of several recordings, which share the offsets with equal `offset_ids`.
// Rows of no recording become 0. CHECKs that series with a common offset have one s and deform
// alike, i.e. all of them with a deformation gradient or none.
Eigen::MatrixXd Whitened(const Eigen::MatrixXd& rows,
                         const std::vector<NoisyRecording>& recordings);

// The temporal correlation of residuals that were whitened under the assumption τ = 0.
struct SeriesStatistics {
  // Correlation of consecutive frames after the mean of each series has been subtracted; 0 if there
  // are too few frames.
  double lag_one = 0;
  double spacing = 0;  // s, the median time between consecutive frames
  // The factor, at least 1, by which correlation increases the variance of a mean over frames:
  // 1 + 2 Σ w_lag ρ_lag over the first lags, with Bartlett's weights w.
  double long_run = 1;
};
SeriesStatistics Statistics(const Eigen::VectorXd& residual, const SeriesLayout& layout);

// Estimates σ of such noise about a straight line through each row (rows × times, without NaN), by
// restricted maximum likelihood over σ and τ (Patterson & Thompson, Biometrika 58, 1971). The plain
// standard deviation of a short record would be too small, because slow noise resembles a trend.
// CHECKs that there are at least three times.
double DeviationAboutTrend(const Eigen::VectorXd& times, const Eigen::MatrixXd& rows);

// τ (s) of the process whose consecutive frames have the correlation `lag_one`; 0 if that is not
// positive.
double CorrelationTime(const SeriesStatistics& statistics);

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_SERIES_NOISE_H_
