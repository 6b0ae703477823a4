// The distance of a predicted motion from the measurements of one recording.
#ifndef LACUNA_PREDICTION_MISFIT_H_
#define LACUNA_PREDICTION_MISFIT_H_

#include <Eigen/Core>
#include <vector>

#include "experiment/observer.h"
#include "fem/prediction.h"
#include "prediction/reaction_misfit.h"

namespace lacuna {

// Predicted minus measured position in one recording, m. A point is a marker or a patch of the
// surface; it has three components, or one along the surface normal (Observer). Rows are ordered
// component within point within frame. Rows of a point that was not seen are 0.
struct Misfit {
  std::vector<int> frames;   // frames of the recording that the prediction reached
  int points = 0;            // number of points in each frame
  Eigen::VectorXd residual;  // components·points·frames
  Eigen::MatrixXd jacobian;  // ∂residual/∂(direction), one column per direction
  // points × frames: the number of measurements of which each is the mean, or the weight that a
  // point has instead (Observed::count); 0: not seen.
  std::vector<double> count;
  // points × frames: the deformation gradient F (Observed), rotated into the recording's
  // coordinates; empty for scans.
  std::vector<Eigen::Matrix3d> deformation;
  std::vector<Observed> observed;  // for each frame: what the prediction was compared with
  // The reaction of each grip that is measured, over the same frames and by the same directions.
  std::vector<ReactionMisfit> reactions;
  PredictionSummary summary;

  Eigen::Index Components() const {
    return count.empty() ? 0 : residual.size() / static_cast<Eigen::Index>(count.size());
  }
  // The residual without the contribution of errors in the points' places on the object
  // (components × points, m).
  Eigen::VectorXd ResidualWithout(const Eigen::MatrixXd& place_offset) const;
};

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_MISFIT_H_
