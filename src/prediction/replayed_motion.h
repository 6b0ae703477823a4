// Runs a fitted model again and keeps the motion that it predicts for one recording: velocities,
// strains and whole states, which the fit does not keep.
#ifndef LACUNA_PREDICTION_REPLAYED_MOTION_H_
#define LACUNA_PREDICTION_REPLAYED_MOTION_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "fem/prediction.h"
#include "fem/reduced_response.h"
#include "prediction/misfit.h"
#include "prediction/recording_model.h"

namespace lacuna {

// Matrices have one column for each chosen frame of the recording. Their rows are the m points, or
// 3m for vectors (x, y, z of a point in three rows). A point is a marker, or the centre of a patch
// of the surface, which moves with the material.
struct ReplayedMotion {
  // Where it is not usable, only the frames that were reached are filled.
  PredictionSummary summary;
  double delay = 0;  // s, delay of the recording's clock; model time is recorded time − delay
  Eigen::VectorXd nuisance;  // values of RecordingModel::nuisances()
  // The transform from the model's to the recording's coordinates. Places are in the latter.
  Eigen::Isometry3d registration = Eigen::Isometry3d::Identity();
  Eigen::MatrixXd predicted;  // 3m, m, places of the points
  // The misfit of the frames, without reactions. The correspondences of scanned points are found
  // anew along this motion. The Jacobian has a column for each of RecordingModel::nuisances(); it
  // is 0 for one whose derivative must be simulated (MisfitDirection::IsSimulated).
  Misfit misfit;
  // Mean over the element that contains the point: the principal value of largest magnitude of the
  // Green–Lagrange strain, and of its rate, 1/s.
  Eigen::MatrixXd strain, strain_rate;
  // The direction against gravity; z if the model has no gravity.
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  bool up_from_gravity = false;
  Eigen::MatrixXd height;  // m, of each point along `up`
  // The equilibrium before the motion, then at most kMostStates − 1 evenly spread frames of the
  // motion, which include the last one. Larger: finer derivatives along the motion, more memory.
  static constexpr int kMostStates = 200;
  std::vector<TrajectoryState> states;
  // The column of each state. For the equilibrium it is that of the last frame before the motion,
  // or −1 if there is none.
  std::vector<int> state_frame;
};

// Predicts the recording with the model's effects, with `further` effects that have no internal
// variables, and with these values of the recording's nuisance parameters. A prediction that stops
// early is reported in the summary.
ReplayedMotion Replay(const RecordingModel& recording, const Eigen::VectorXd& nuisance,
                      const EffectList& further = {});

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_REPLAYED_MOTION_H_
