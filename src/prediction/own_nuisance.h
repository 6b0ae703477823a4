// The nuisances of a recording that is only predicted.
#ifndef LACUNA_PREDICTION_OWN_NUISANCE_H_
#define LACUNA_PREDICTION_OWN_NUISANCE_H_

#include <Eigen/Core>
#include <optional>

#include "analysis/measurement_errors.h"
#include "prediction/predicted_motion.h"

namespace lacuna {

// Fitted to the first tenth of the recording, the model staying as it is; with the errors of its
// markers' places (3 × markers, m) where other recordings tell them. Empty where that cannot be
// predicted.
Eigen::VectorXd OwnNuisance(const RecordingModel& model, MeasurementErrors errors,
                            const std::optional<Eigen::MatrixXd>& place_offset);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_OWN_NUISANCE_H_
