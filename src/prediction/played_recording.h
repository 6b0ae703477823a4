// Plays a recording of markers: what they and the load cells would show if the model were the
// object.
#ifndef LACUNA_PREDICTION_PLAYED_RECORDING_H_
#define LACUNA_PREDICTION_PLAYED_RECORDING_H_

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "fem/prediction.h"
#include "prediction/recording_model.h"
#include "scan/recording_writer.h"

namespace lacuna {

struct PlayedRecording {
  PredictionSummary summary;                 // not usable: only the first frames are there
  std::vector<double> times;                 // s, of the used frames, in the recording's time
  std::vector<Eigen::Matrix3Xd> positions;   // 3 × nodes, m, in the model's coordinates
  std::vector<Eigen::Matrix3Xd> velocities;  // m/s
  std::vector<Eigen::Matrix3Xd> markers;     // 3 × markers, m, in the recording's coordinates
  // N, over the frames that the readings cover, with the tare and the delay of the simulated cells.
  std::vector<MeasuredReaction> reactions;
};

// The values of nuisances() with which a fit starts, the force of the hold among them. Throws
// InputError where the object is held by a force that is not given: it cannot be played.
Eigen::VectorXd PlayedNuisances(const RecordingModel& model);

// Plays the frames that are used. The recording must be one of markers (CHECKed). Throws
// Interrupted.
PlayedRecording Play(const RecordingModel& model, const Eigen::VectorXd& nuisance);

// The recording with the played markers and forces in place of the measured ones. Each coordinate
// has a normal error of standard deviation `noise`, m, also where the measured points had a σ of
// their own, and each force one of the deviation of its load cell; the same `seed` gives the same
// errors.
MarkerRecording AsRecording(const PredictedRecording& item, const PlayedRecording& played,
                            double noise, uint64_t seed);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_PLAYED_RECORDING_H_
