// Predicted minus measured reactions of the grips of one recording (scan/measured_reaction.h).
//
// The reaction is compared in the coordinate system of the fixture, which is the model's, at the
// times of the frames. The load cell shares the recording's clock; the registration of markers does
// not concern it. Its offset (tare) is a nuisance with a Gaussian prior of mean 0, which the
// measurement errors contain (analysis/measurement_errors.h): the same error in all frames.
#ifndef LACUNA_PREDICTION_REACTION_MISFIT_H_
#define LACUNA_PREDICTION_REACTION_MISFIT_H_

#include <Eigen/Core>
#include <vector>

#include "analysis/measurement_errors.h"
#include "fem/prediction.h"
#include "prediction/misfit_direction.h"
#include "scan/measured_reaction.h"

namespace lacuna {

// The misfit of one reading. Rows are ordered component within frame; they are 0 in frames that the
// reading does not cover.
struct ReactionMisfit {
  int components = 0;
  Eigen::VectorXd residual;  // components·frames, N
  Eigen::MatrixXd jacobian;  // ∂residual/∂(direction), N per unit
  std::vector<int> count;    // components·frames: 1, or 0 where there is no reading
};

// The indices of the grips that are measured, in Model::grips of a RecordingModel, one per reading.
std::vector<size_t> MeasuredGrips(const std::vector<MeasuredReaction>& readings);

// Appends a frame at `time` (s, the recording's) to the misfit of each reading. `state` has the
// reactions of MeasuredGrips(). Before `start_time`, s, a delay of the clock changes nothing.
void AppendReactions(const std::vector<MeasuredReaction>& readings, double time,
                     const PredictedState& state, double start_time,
                     const std::vector<MisfitDirection>& directions,
                     std::vector<ReactionMisfit>* misfits);

// The errors of a reading, N in place of m.
MeasurementErrors ReadingErrors(const MeasuredReaction& reading);

// The posterior mean of the offset of each component, N, given the frames `among` (one flag per
// frame): predicted minus measured.
Eigen::VectorXd TareOf(const ReactionMisfit& misfit, const MeasuredReaction& reading,
                       const std::vector<char>& among);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_REACTION_MISFIT_H_
