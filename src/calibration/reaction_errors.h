// How well a fitted model predicts the measured reactions of the grips, and how much these
// readings determine.
#ifndef LACUNA_CALIBRATION_REACTION_ERRORS_H_
#define LACUNA_CALIBRATION_REACTION_ERRORS_H_

#include <Eigen/Core>
#include <vector>

#include "calibration/calibration_problem.h"
#include "record/csv_table.h"
#include "record/fitted_reaction.h"

namespace lacuna {

struct RecordingMisfit;  // calibration/held_out_misfit.h

// The errors of one reading without its tare, which is determined from the frames `tells_tare`.
// Both lists have one flag per frame of the misfit.
FittedReaction MeasureReaction(const MeasuredReaction& reading, const ReactionMisfit& misfit,
                               const std::vector<char>& fitted,
                               const std::vector<char>& tells_tare);

// The table reactions.csv: for each component of each reading in each frame of each recording, the
// mean displacement of the grip along the component relative to the other grips (m), the reading and the difference predicted −
// measured without the tare (N). Both forces are NaN in frames that the reading does not cover.
// Empty where no reaction is measured.
CsvTable ReactionTable(const CalibrationProblem& problem,
                       const std::vector<RecordingMisfit>& misfits);

// FittedParameter::share_of_forces for each parameter of the problem; empty where no fitted
// recording has a reading or the model cannot be linearised. Throws Interrupted.
std::vector<double> SharesOfForces(const CalibrationProblem& problem,
                                   const Eigen::VectorXd& values);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_REACTION_ERRORS_H_
