// Predicted minus measured reactions of the grips of one recording (scan/measured_reaction.h).
//
// The reaction is compared in the coordinate system of the fixture, which is the model's, at the
// times of the frames. The load cell shares the recording's clock, unless it has a delay d of its
// own: a value that is stamped t is then that of t − d. The registration of markers does not
// concern it. Its offset (tare) is a nuisance with a Gaussian prior of mean 0, which the
// measurement errors contain (analysis/measurement_errors.h): the same error in all frames. An
// unknown sign is the one with the smaller misfit.
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
  Eigen::VectorXd residual;   // components·frames, N or N m: predicted − sign·measured
  Eigen::MatrixXd jacobian;   // ∂residual/∂(direction), per unit
  std::vector<double> count;  // components·frames: 1, or 0 where there is no reading
  double sign = 1;
};

// The reactions that are measured, one per reading, for the model of a RecordingModel. A torque
// refers to a point of the grip at its recorded place; the point does not follow a placement of the
// grip (prediction/grip_placement.h).
std::vector<Reaction> MeasuredReactions(const std::vector<MeasuredReaction>& readings,
                                        const Model& model);

// Appends a frame at `time` (s, the recording's) to the misfit of reading `k`, with the sign +1.
// `state` has the reactions of MeasuredReactions(), at the time of the reading. Before
// `start_time`, s, a delay changes nothing.
void AppendReaction(const std::vector<MeasuredReaction>& readings, size_t k, double time,
                    const PredictedState& state, double start_time,
                    const std::vector<MisfitDirection>& directions, ReactionMisfit* misfit);

// Completes a misfit whose reading may have either sign: takes the one with the smaller misfit.
// `times` (s) are those of the frames.
void ChooseSign(const MeasuredReaction& reading, const std::vector<double>& times,
                ReactionMisfit* misfit);

// The errors of a reading, N in place of m.
MeasurementErrors ReadingErrors(const MeasuredReaction& reading);

// The posterior mean of the offset of each component, N, given the frames `among` (one flag per
// frame): predicted minus measured.
Eigen::VectorXd TareOf(const ReactionMisfit& misfit, const MeasuredReaction& reading,
                       const std::vector<char>& among);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_REACTION_MISFIT_H_
