// The motion of the whole body that a model predicts for a recording, at some of its frames, and
// what a report shows of it.
#ifndef LACUNA_PREDICTION_PREDICTED_STATES_H_
#define LACUNA_PREDICTION_PREDICTED_STATES_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "fem/prediction.h"
#include "fem/reduced_response.h"
#include "prediction/recording_model.h"
#include "prediction/smooth_force.h"
#include "record/motion_record.h"

namespace lacuna {

struct PredictedStates {
  PredictionSummary summary;  // not usable: only the states that were reached are there
  double delay = 0;           // s, of the recording's clock; model time is recorded time − delay
  Eigen::Isometry3d registration = Eigen::Isometry3d::Identity();  // model to recording
  std::vector<TrajectoryState> states;                             // in the model's coordinates
};

// Predicts the recording, of markers or of scans, with these values of its nuisance parameters, and
// keeps the states at `most` of its chosen frames, evenly spread. Internal variables of effects are
// advanced from frame to frame (effect_memory.h). Throws Interrupted.
PredictedStates PredictStates(const RecordingModel& recording, const Eigen::VectorXd& nuisance,
                              int most = kMostShownFrames);

// The surface of the body in these states, in the recording's coordinates, with the fields
// displacement, speed, strain (the mean of the largest principal Green–Lagrange strains of the
// elements at a node, weighted by volume), von Mises stress and largest principal stretch
// (nodal_recovery.h) and, where `force` is given, the density of that force. A note says where
// vertices or frames were left out. `fit` is left empty.
MotionRecord ShownMotion(const RecordingModel& recording, const PredictedStates& predicted,
                         const SmoothForce* force = nullptr);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_PREDICTED_STATES_H_
