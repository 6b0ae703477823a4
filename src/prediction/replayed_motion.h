// The motion that a fitted model predicts for a recording, run again: what the markers' misfits
// alone do not keep.
#ifndef LACUNA_PREDICTION_REPLAYED_MOTION_H_
#define LACUNA_PREDICTION_REPLAYED_MOTION_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "fem/prediction.h"
#include "fem/reduced_response.h"
#include "prediction/predicted_motion.h"

namespace lacuna {

// Rows are markers (3 rows each where they are vectors), columns the recording's chosen frames.
struct ReplayedMotion {
  PredictionSummary summary;
  double delay = 0;  // s, by which the recording's clock is late: model time = time − delay
  Eigen::VectorXd nuisance;  // of the recording
  // From the model to the measuring frame, in which are:
  Eigen::Isometry3d registration = Eigen::Isometry3d::Identity();
  Eigen::MatrixXd predicted;                 // m, the markers' places
  Eigen::MatrixXd velocity;                  // m/s
  std::vector<Eigen::Matrix3d> deformation;  // markers × frames: F at each
  // Of the element that the marker sits in, the mean over it: the largest magnitude among the
  // principal Green–Lagrange strains, and among those of the strain's rate, 1/s.
  Eigen::MatrixXd strain, strain_rate;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  bool up_from_gravity = false;  // else z
  Eigen::MatrixXd height;        // m, of the marker along `up`
  // The equilibrium before the motion, then at most kMostStates frames, evenly spread, the last
  // one always.
  static constexpr int kMostStates = 200;
  std::vector<TrajectoryState> states;
  // Column of each state; of the first that of the last frame before the motion, −1: there is none.
  std::vector<int> state_frame;
};

// With the model's effects as they are, further forces that have no memory, and the recording's
// nuisances (RecordingModel::nuisances). A prediction that stops leaves the summary alone.
ReplayedMotion Replay(const RecordingModel& model, const Eigen::VectorXd& nuisance,
                      const EffectList& further = {});

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_REPLAYED_MOTION_H_
