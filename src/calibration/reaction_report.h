// The details of measured reactions that a run keeps, and how much these readings determine.
#ifndef LACUNA_CALIBRATION_REACTION_REPORT_H_
#define LACUNA_CALIBRATION_REACTION_REPORT_H_

#include <Eigen/Core>
#include <vector>

#include "calibration/calibration_problem.h"
#include "calibration/held_out_misfit.h"
#include "record/csv_table.h"

namespace lacuna {

// The table reactions.csv of forces: for each component of each reading in each frame of each
// recording, the mean displacement of the grip along the component relative to the other grips (m),
// the reading, with the sign of the force that the grip exerts, and the difference predicted −
// measured without the tare (N). Both forces are NaN in frames that the reading does not cover.
// Empty where no force is measured.
//
// `torques`: the table torques.csv instead, with the grip's rotation about the component (rad) and
// torques (N m).
CsvTable ReactionTable(const CalibrationProblem& problem,
                       const std::vector<RecordingMisfit>& misfits, bool torques);

// FittedParameter::share_of_forces for each parameter of the problem; empty where no fitted
// recording has a reading or the model cannot be linearised. Throws Interrupted.
std::vector<double> SharesOfForces(const CalibrationProblem& problem,
                                   const Eigen::VectorXd& values);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_REACTION_REPORT_H_
