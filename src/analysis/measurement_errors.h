// The errors of measurements, and residuals in units of them.
#ifndef LACUNA_ANALYSIS_MEASUREMENT_ERRORS_H_
#define LACUNA_ANALYSIS_MEASUREMENT_ERRORS_H_

#include <Eigen/Core>
#include <vector>

namespace lacuna {

// Of each component of each point (a marker, or a patch of a surface), over the frames f that saw
// it as the mean of n_f measurements: covariance diag(σ²/n_f) + s² 1 1ᵀ. Where F_f, the deformation
// gradient at each point in each frame (points × frames), is given, the common part is an error of
// the point's place on the undeformed object, and shows as F_f times that: s² F_f F_gᵀ in place of
// s² 1 1ᵀ (analysis/series_noise.h).
struct MeasurementErrors {
  double noise = 0;   // σ, m, of one measurement: the white part
  double common = 0;  // s, m: what is the same in all frames, as the point's place on the object
                      // is known to s only
};

// Rows (components of points, frames outermost; a residual, or the columns of its derivative) times
// the inverse square root of the covariance. `count` (points × frames) holds the n_f; rows of
// points that were not seen (0) must be 0.
Eigen::MatrixXd Whitened(const Eigen::MatrixXd& rows, const std::vector<int>& count, int points,
                         const MeasurementErrors& errors,
                         const std::vector<Eigen::Matrix3d>& deformation = {});

// What is common to the frames `among` (a flag for each), components × points, m, on the undeformed
// object: the mean of the posterior of that part of the errors, given the residual.
Eigen::MatrixXd CommonError(const Eigen::VectorXd& residual, const std::vector<int>& count,
                            int points, const MeasurementErrors& errors,
                            const std::vector<char>& among,
                            const std::vector<Eigen::Matrix3d>& deformation = {});

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_MEASUREMENT_ERRORS_H_
