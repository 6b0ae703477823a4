// The nuisance parameters of a recording that is predicted but not fitted.
#ifndef LACUNA_PREDICTION_RECORDING_NUISANCES_H_
#define LACUNA_PREDICTION_RECORDING_NUISANCES_H_

#include <Eigen/Core>
#include <optional>

#include "analysis/measurement_errors.h"
#include "prediction/recording_model.h"

namespace lacuna {

// Fits them to the first tenth of the recording while the model is kept fixed. `place_offset` holds
// the errors of its markers' places (3 × markers, m) where another recording has determined them.
// Returns an empty vector where the model cannot be simulated.
Eigen::VectorXd FitRecordingNuisances(const RecordingModel& model, MeasurementErrors errors,
                                      const std::optional<Eigen::MatrixXd>& place_offset);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_RECORDING_NUISANCES_H_
