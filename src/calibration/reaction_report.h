// The details of measured reactions that a run keeps.
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
// measured without the tare (N). Displacement and prediction are those at the time of the reading,
// which the delays of the clock and of the load cell shift. Both forces are NaN in frames that the
// reading does not cover. Empty where no force is measured.
//
// `torques`: the table torques.csv instead, with the grip's rotation about the component (rad) and
// torques (N m).
CsvTable ReactionTable(const CalibrationProblem& problem,
                       const std::vector<RecordingMisfit>& misfits, bool torques);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_REACTION_REPORT_H_
