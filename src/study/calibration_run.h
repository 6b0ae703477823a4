// Runs the fit of a prediction study and keeps what it found in a run directory.
#ifndef LACUNA_STUDY_CALIBRATION_RUN_H_
#define LACUNA_STUDY_CALIBRATION_RUN_H_

#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"
#include "study/calibration_problem.h"

namespace lacuna {

struct FittedParameter {
  std::string name, unit;  // SI
  bool log_scale = false;
  ParameterEstimate estimate;
};

struct FittedRecording {
  std::string name;
  bool fitted = true;
  double noise = 0;  // m, the white part, as this recording's own differences tell it
  MisfitMeasure in_fit, held_out;
};

// calibration/calibration.json
struct CalibrationRecord {
  std::filesystem::path experiment;
  bool usable = false;
  std::string message;
  double noise = 0;               // m, that residuals are weighed with
  double start_rms = 0, rms = 0;  // of the whitened residuals, before and after
  int predictions = 0;
  std::vector<FittedParameter> parameters;  // the model's, then the recordings'
  std::vector<FittedRecording> recordings;
  // What the fit took for granted against its prior: markers far from where the recording has them,
  // a clock or a hold far from what was allowed. Physics may hide there.
  std::vector<std::string> strains;
  MeshRecord mesh;
};

// The mesh stage and the calibration stage: calibration.json and misfit.csv (each marker of each
// frame: predicted, measured, difference). Throws InputError and Interrupted.
CalibrationRecord RunCalibration(const PredictionStudy& study, Progress* progress);

// Of a finished run. Throws InputError.
CalibrationRecord LoadCalibration(const std::filesystem::path& run);

// A finished run, opened again: its experiment is read anew and must be the one that was fitted.
struct FittedRun {
  PredictionStudy study;
  CalibrationRecord record;
  TetMesh mesh;
  Eigen::VectorXd values;  // of all parameters
};
// Throws InputError when the run is not finished or its fit not usable, or when the experiment has
// changed since.
FittedRun OpenRun(const std::filesystem::path& run);

std::string VerdictName(ParameterEstimate::Verdict verdict);

}  // namespace lacuna

#endif  // LACUNA_STUDY_CALIBRATION_RUN_H_
