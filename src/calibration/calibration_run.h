// Runs the fit of a prediction study and keeps its result in a run directory.
#ifndef LACUNA_CALIBRATION_CALIBRATION_RUN_H_
#define LACUNA_CALIBRATION_CALIBRATION_RUN_H_

#include <filesystem>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "core/progress.h"
#include "record/calibration_record.h"

namespace lacuna {

// Runs the stages mesh and calibration, or reads back those that are up to date. They write
// calibration.json, misfit.csv (the measured place and the difference of each marker or patch in
// each frame) and, where forces or torques are measured, reactions.csv or torques.csv. Throws
// InputError and Interrupted.
CalibrationRecord RunCalibration(const PredictionStudy& study, Progress* progress);

// The record of a finished run. Throws InputError where there is none.
CalibrationRecord ReadCalibration(const std::filesystem::path& run);

// A finished run that was opened again. Its experiment and recordings are read again and must be
// those that were fitted.
struct FittedRun {
  PredictionStudy study;  // with its effects at the fitted values
  CalibrationRecord record;
  TetMesh mesh;
  Eigen::VectorXd values;  // fitted values of all parameters of the problem
};
// Throws InputError when the folder is not that of a `lacuna fit`, the run is not finished or its
// fit not usable, or when the experiment or a recording has changed since.
FittedRun OpenRun(const std::filesystem::path& run);
// Throws InputError when the folder does not exist, is not a run, or is a run of another command.
void RefuseOtherRuns(const std::filesystem::path& run);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_CALIBRATION_RUN_H_
