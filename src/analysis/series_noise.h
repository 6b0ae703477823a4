// Noise of a measurement that repeats itself over frames, and its whitening.
//
// Of each series y (one coordinate of one marker, say) the noise is
//   e ~ N(0, σ² R + s² 1 1ᵀ),   R_ij = exp(−|t_i − t_j|/τ):
// correlated over a time τ (an Ornstein–Uhlenbeck process; 0: white) and with a part that is common
// to all frames, as a marker's place on the object is known to s only. That part turns and
// stretches with the object: where its deformation gradient F_t at the marker is given, the three
// coordinates share s² F_t F_uᵀ between frames t and u. A value that is the mean of n measurements
// has σ/√n for σ. Rows of a recording: its series in each frame, frames outermost.
#ifndef LACUNA_ANALYSIS_SERIES_NOISE_H_
#define LACUNA_ANALYSIS_SERIES_NOISE_H_

#include <Eigen/Core>
#include <vector>

namespace lacuna {

struct SeriesLayout {
  int series = 0;
  std::vector<double> times;  // s, ascending, of the frames
  std::vector<int> count;     // series × frames: n, 0 where nothing was observed
  // (series/3) × frames: F of the point that three successive series are coordinates of; empty: 1.
  std::vector<Eigen::Matrix3d> deformation;

  Eigen::Index Rows() const {
    return static_cast<Eigen::Index>(series) * static_cast<Eigen::Index>(times.size());
  }
};

struct SeriesNoise {
  double deviation = 1;         // σ, in the unit of the rows
  double correlation_time = 0;  // τ, s
  double offset_deviation = 0;  // s
};

// Σ^(−1/2) of each column; rows that were not observed, or whose frame is not in `frames` (empty:
// all are), become 0 and the others are whitened as if those frames were not there.
Eigen::MatrixXd Whitened(const Eigen::MatrixXd& rows, const SeriesLayout& layout,
                         const SeriesNoise& noise, const std::vector<char>& frames = {});

// What residuals say of noise that was whitened as if it were white.
struct SeriesStatistics {
  // Correlation of neighbouring frames, after each series' mean was taken away; 0 where there is
  // too little to tell.
  double lag_one = 0;
  double spacing = 0;  // s, the median distance of neighbouring frames
  // Σ_lag ρ over the first lags (Bartlett's window): how many times larger the variance of a mean
  // over frames is than if frames were unrelated; at least 1.
  double long_run = 1;
};
SeriesStatistics Statistics(const Eigen::VectorXd& residual, const SeriesLayout& layout);

// σ of such noise about a straight line of each row (rows × times, every entry seen), by restricted
// maximum likelihood over σ and τ (Patterson & Thompson, Biometrika 58, 1971): the plain deviation
// of a short record is too small, as slow noise passes for a trend. Needs three times.
double DeviationAboutTrend(const Eigen::VectorXd& times, const Eigen::MatrixXd& rows);

// τ of the process whose neighbouring frames have that correlation; 0 where it is not positive.
double CorrelationTime(const SeriesStatistics& statistics);

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_SERIES_NOISE_H_
