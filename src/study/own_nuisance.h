// The nuisances of a recording that is only predicted.
#ifndef LACUNA_STUDY_OWN_NUISANCE_H_
#define LACUNA_STUDY_OWN_NUISANCE_H_

#include <Eigen/Core>

#include "study/measurement_errors.h"
#include "study/predicted_motion.h"

namespace lacuna {

// Fitted to the first tenth of the recording, the model staying as it is. Empty where that cannot
// be predicted.
Eigen::VectorXd OwnNuisance(const RecordingModel& model, const MeasurementErrors& errors);

}  // namespace lacuna

#endif  // LACUNA_STUDY_OWN_NUISANCE_H_
