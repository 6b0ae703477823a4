// The change of a recording's measurements by forces, from the reduced tangent-linear model along a
// replayed motion (fem/reduced_response.h).
#ifndef LACUNA_PREDICTION_OBSERVED_RESPONSE_H_
#define LACUNA_PREDICTION_OBSERVED_RESPONSE_H_

#include <Eigen/Core>
#include <vector>

#include "experiment/observer.h"
#include "fem/reduced_response.h"
#include "prediction/recording_model.h"
#include "prediction/replayed_motion.h"

namespace lacuna {

// The change of the residuals, m, with one column for each of the force histories that
// `response.Respond(held, histories, …)` takes. The rows are those of the chosen frames of the
// misfit: components × points for each frame, 0 for points that were not seen. `frames` are
// ascending indices of the model's frames; `observed` has an entry for each of the latter, in the
// recording's coordinates.
Eigen::MatrixXd ObservedResponse(const RecordingModel& recording, const ReplayedMotion& motion,
                                 const ReducedResponse& response, const Eigen::MatrixXd& held,
                                 const ForceHistories& histories, const std::vector<int>& frames,
                                 const std::vector<Observed>& observed);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_OBSERVED_RESPONSE_H_
