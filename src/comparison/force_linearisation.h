// The residual of one recording, of markers or of scans, and its derivatives with respect to a
// smooth force and to the recording's nuisance parameters.
#ifndef LACUNA_COMPARISON_FORCE_LINEARISATION_H_
#define LACUNA_COMPARISON_FORCE_LINEARISATION_H_

#include <Eigen/Core>
#include <vector>

#include "analysis/measurement_errors.h"
#include "fem/reduced_response.h"
#include "prediction/recording_model.h"
#include "prediction/replayed_motion.h"
#include "prediction/smooth_force.h"

namespace lacuna {

// Whitened residual, predicted minus measured, and its Jacobians. Rows are x, y, z of each marker,
// or the distance of each patch along its normal, of each frame that is used, frames outermost;
// rows of a point that was not observed are 0. Scanned points keep their correspondences in the
// Jacobians, as in the fit (experiment/surface_observer.h).
struct LinearisedForce {
  int coordinates = 0;  // number of rows that were observed
  Eigen::VectorXd residual;
  Eigen::MatrixXd force_jacobian;     // columns: SmoothForce::amplitudes column by column
  Eigen::MatrixXd nuisance_jacobian;  // columns: RecordingModel::nuisances()
  // For each nuisance, whether it keeps its value: its column is left out (0). The delay of a load
  // cell does not change the points. The placement of a grip stays as fitted, since moving a grip
  // changes the motion as forces do.
  std::vector<char> is_kept;
  double Rms(const Eigen::VectorXd& rows) const;
};

// The derivatives come from the tangent-linear model along a motion, projected on a small basis
// (fem/reduced_response.h). Where a recording has very many frames, an evenly spread subset is
// used.
class ForceLinearisation {
 public:
  // The recording's model and the field must outlive this. `errors` whitens the residual as in the
  // fit; errors of the markers' places follow the deformation of `motion`, which must reach the
  // last frame.
  ForceLinearisation(const RecordingModel& recording, const ReplayedMotion& motion,
                     const SmoothForce& field, const MeasurementErrors& errors);

  // Standard deviations of the nuisance parameters' priors, whose means are 0.
  const Eigen::VectorXd& prior_deviations() const { return prior_deviations_; }

  // The response of a motion to small forces; may be unusable (ReducedResponse::IsUsable).
  ReducedResponse Response(const ReplayedMotion& motion) const;
  // The number of rows that were observed along a motion. That of markers is the same for all
  // motions.
  int Coordinates(const ReplayedMotion& motion) const;
  // The rms over these rows of the whitened residual.
  double Rms(const ReplayedMotion& motion) const;
  LinearisedForce Linearise(const ReplayedMotion& motion, const ReducedResponse& response) const;

 private:
  Eigen::Index RowsOfFrame() const { return components_ * recording_.PointCount(); }
  Eigen::Index Rows() const { return RowsOfFrame() * static_cast<Eigen::Index>(frames_.size()); }
  // Misfit::count of the used frames.
  std::vector<double> Counts(const ReplayedMotion& motion) const;
  // The rows of the used frames, of rows of all frames of the motion.
  Eigen::MatrixXd OfUsedFrames(const Eigen::MatrixXd& all) const;
  Eigen::VectorXd WhitenedResidual(const ReplayedMotion& motion) const;
  Eigen::MatrixXd Whiten(const Eigen::MatrixXd& rows, const ReplayedMotion& motion) const;
  // The rows of the observed points per unit of each amplitude, and of each nuisance that is a
  // holding force (0 for the others).
  Eigen::MatrixXd ForceRows(const ReplayedMotion& motion, const ReducedResponse& response) const;

  const RecordingModel& recording_;
  const SmoothForce& field_;
  MeasurementErrors errors_;
  Eigen::Index components_;  // rows of a point: 3 of a marker, 1 of a patch
  Eigen::MatrixXd shapes_;   // 3n × k, nodal shapes of the field, then of the holding forces
  Eigen::VectorXd prior_deviations_;
  std::vector<Eigen::Index> held_shape_;  // for each nuisance: column in shapes_, −1: no force
  std::vector<int> frames_;               // frames that are used, as columns of the motion
  std::vector<Eigen::Matrix3d> deformation_;  // markers × used frames; empty for scans
};

}  // namespace lacuna

#endif  // LACUNA_COMPARISON_FORCE_LINEARISATION_H_
