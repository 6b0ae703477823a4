// What a fit found: calibration.json.
#ifndef LACUNA_CALIBRATION_CALIBRATION_RECORD_H_
#define LACUNA_CALIBRATION_CALIBRATION_RECORD_H_

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/recording_misfit.h"
#include "fit/calibration.h"
#include "record/run_record.h"

namespace lacuna {

struct FittedParameter {
  std::string name, unit;  // SI
  bool log_scale = false;
  ParameterEstimate estimate;
  // What would be fitted with elements as fine as can be; absent where it was not to be had. The
  // estimate's interval counts it.
  std::optional<double> with_finest_mesh;
};

// Of a recording of scans.
struct FittedScan {
  Eigen::Matrix3Xd places;  // of the patches on the undeformed object, m
  double patch_noise = 0;   // m, of a patch's mean in one frame, rms over all that were seen
  double used = 0;          // share of the frames' points that were compared
};

// What a recording that is not fitted tells of itself: what held the object, its clock, its
// registration.
struct OwnValue {
  std::string name, unit;
  double value = 0;  // SI
};

struct FittedRecording {
  std::string name;
  bool fitted = true;
  double noise = 0;  // m, the white part, as this recording's own points tell it
  MisfitMeasure in_fit, held_out;
  std::optional<FittedScan> scan;  // absent: markers
  std::vector<OwnValue> own = {};  // found from its first tenth; of a fitted one among parameters
};

// calibration/calibration.json
struct CalibrationRecord {
  std::filesystem::path experiment;
  bool usable = false;
  std::string message;
  // m, of a marker's coordinate and of a scanned point along the normal, that residuals are weighed
  // with; 0: there are none.
  double noise = 0, scan_noise = 0;
  double time_step = 0;           // s, of the simulation
  double step_error = 0;          // what half of it would change, σ; 0: the step was given
  double start_rms = 0, rms = 0;  // of the whitened residuals, before and after
  int predictions = 0;
  std::vector<FittedParameter> parameters;  // the model's, then the recordings'
  std::vector<FittedRecording> recordings;
  // What the fit took for granted against its prior: markers far from where the recording has them,
  // a clock or a hold far from what was allowed. Physics may hide there.
  std::vector<std::string> strains;
  MeshRecord mesh;
  std::vector<std::string> mesh_notes;  // of a run just made; the file has neither
};

std::string VerdictName(ParameterEstimate::Verdict verdict);

// What is infinite becomes null.
nlohmann::json EstimateToJson(const ParameterEstimate& estimate);
// Throws nlohmann::json::exception.
ParameterEstimate EstimateFromJson(const nlohmann::json& value);

void WriteCalibrationFile(const CalibrationRecord& record, const std::filesystem::path& file);
// Throws InputError when it is not one.
CalibrationRecord ReadCalibrationFile(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_CALIBRATION_RECORD_H_
