// The errors of measurements, and residuals in units of them.
#ifndef LACUNA_ANALYSIS_MEASUREMENT_ERRORS_H_
#define LACUNA_ANALYSIS_MEASUREMENT_ERRORS_H_

#include <Eigen/Core>
#include <vector>

namespace lacuna {

// Each component of each point (a marker, or a patch of a surface) is observed in the frames f as
// the mean of n_f measurements, and its errors have the covariance diag(σ²/n_f) + s² 1 1ᵀ. n_f is
// the weight of the point, which need not be whole: a marker whose error is σ_f counts as (σ/σ_f)²
// measurements. If the
// deformation gradient F_f at each point in each frame (points × frames) is given, the common part
// is an error of the point's place on the undeformed object, which is multiplied by F_f: the second
// term is then s² F_f F_gᵀ (analysis/series_noise.h).
struct MeasurementErrors {
  double noise = 0;   // σ, m: white noise of one measurement
  double common = 0;  // s, m: error that is the same in all frames, because the point's place on
                      // the object is known only to within s
};

// The inverse square root of the covariance times `rows` (components of points, frames outermost),
// a residual or its Jacobian. `count` (points × frames) holds the n_f; rows of points that were not
// seen (0) must be 0.
Eigen::MatrixXd Whitened(const Eigen::MatrixXd& rows, const std::vector<double>& count, int points,
                         const MeasurementErrors& errors,
                         const std::vector<Eigen::Matrix3d>& deformation = {});

// The posterior mean of the common part of the errors of `places`, from the residuals of the
// recordings that show them.
class CommonErrors {
 public:
  CommonErrors(Eigen::Index components, Eigen::Index places);

  // Adds the frames `among` (one flag per frame) of a recording, whose points are at these places.
  // The deviation s of a place must be the same in all recordings.
  void Add(const Eigen::VectorXd& residual, const std::vector<double>& count,
           const MeasurementErrors& errors, const std::vector<char>& among,
           const std::vector<Eigen::Matrix3d>& deformation, const std::vector<int>& place_of_point);
  // Components × places, m, on the undeformed object; 0 where nothing was seen.
  Eigen::MatrixXd Mean() const;

 private:
  Eigen::Index components_;
  std::vector<Eigen::MatrixXd> information_;  // of each place, in units of 1/s²
  Eigen::MatrixXd toward_;                    // components × places, m
};

// The same from one recording of `points` points.
Eigen::MatrixXd CommonError(const Eigen::VectorXd& residual, const std::vector<double>& count,
                            int points, const MeasurementErrors& errors,
                            const std::vector<char>& among,
                            const std::vector<Eigen::Matrix3d>& deformation = {});

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_MEASUREMENT_ERRORS_H_
