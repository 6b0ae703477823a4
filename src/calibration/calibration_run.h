// Runs the fit of a prediction study and keeps what it found in a run directory.
#ifndef LACUNA_CALIBRATION_CALIBRATION_RUN_H_
#define LACUNA_CALIBRATION_CALIBRATION_RUN_H_

#include <filesystem>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "core/progress.h"
#include "record/calibration_record.h"

namespace lacuna {

// The mesh stage and the calibration stage: calibration.json and misfit.csv (each marker or
// patch of each frame: measured, difference). Throws InputError and Interrupted.
CalibrationRecord RunCalibration(const PredictionStudy& study, Progress* progress);

// Of a finished run. Throws InputError.
CalibrationRecord LoadCalibration(const std::filesystem::path& run);

// A finished run, opened again: its experiment and recordings are read anew and must be what was
// fitted.
struct FittedRun {
  PredictionStudy study;  // its effects as they were fitted
  CalibrationRecord record;
  TetMesh mesh;
  Eigen::VectorXd values;  // of all parameters
};
// Throws InputError when the folder is not that of a `lacuna fit`, the run is not finished or its
// fit not usable, or when the experiment or a recording has changed since.
FittedRun OpenRun(const std::filesystem::path& run);
// Throws InputError when the folder is not there, no run, or one of another command.
void RefuseOtherRuns(const std::filesystem::path& run);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_CALIBRATION_RUN_H_
