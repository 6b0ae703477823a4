// The result of a fit as plain data: calibration/calibration.json in the run's folder.
//
// Lengths and values are in SI units. σ is the standard deviation of the measurement noise.
#ifndef LACUNA_RECORD_CALIBRATION_RECORD_H_
#define LACUNA_RECORD_CALIBRATION_RECORD_H_

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "record/by_data_kind.h"
#include "record/fitted_reaction.h"
#include "record/model_errors.h"
#include "record/parameter_estimate.h"
#include "record/prior_conflict.h"
#include "record/run_record.h"

namespace lacuna {

// A bound that the value or the 95 % interval of a parameter comes near: within 1 % of the distance
// between its bounds, on the scale on which it is fitted, or where that is infinite, up to the
// bound itself.
struct NearBound {
  bool is_upper = false;
  double bound = 0;
};
// `low` and `high`: the bounds of a fit, SI. Nothing for a parameter that the data do not
// determine.
std::optional<NearBound> FindNearBound(const ParameterEstimate& estimate, bool log_scale,
                                       double low, double high);

// How much of the information about a parameter comes from each kind of data: its part of
// Σ (∂r/∂θ)², summed over the whitened rows of the fitted data, with all other parameters fixed.
// The sum of the shares is 1.
using DataShares = ByDataKind;

struct FittedParameter {
  std::string name, unit;
  bool log_scale = false;  // estimated on a logarithmic scale
  ParameterEstimate estimate;
  // The value extrapolated to infinitely fine elements; absent where this was not possible.
  std::optional<double> with_finest_mesh;
  std::optional<NearBound> near_bound = {};
  // The value extrapolated to infinitely fine elements, where possible, and infinitely short time
  // steps. The interval is centred there. Absent where the model misses the data by far.
  std::optional<double> at_limit = {};
  // Absent where the fit has one kind of data only, and where no prediction depends on it.
  std::optional<DataShares> shares = {};
};

// A parameter of the model that is not fitted: one value, or the components of a vector.
struct HeldParameter {
  std::string name, unit;
  std::vector<double> values;
};

// Additional data of a recording of surface scans.
struct FittedScan {
  Eigen::Matrix3Xd places;  // m, places of the patches on the undeformed object
  double patch_noise = 0;   // m, noise of a patch's mean in one frame, rms over all patches
  double used = 0;          // share of the scanned points that were compared
};

// A nuisance parameter of a recording that is not fitted: its clock, its grips, its registration.
struct OwnValue {
  std::string name, unit;
  double value = 0;
};

struct FittedRecording {
  std::string name;
  bool fitted = true;
  double noise = 0;  // m, the white part of the noise, estimated from this recording
  MisfitMeasure in_fit, held_out;
  std::optional<FittedScan> scan;  // absent for markers
  // Estimated from the first tenth of the recording. Empty for a fitted recording, whose nuisance
  // parameters are among CalibrationRecord::parameters.
  std::vector<OwnValue> own = {};
  std::vector<FittedReaction> reactions = {};  // measured forces of its grips
  std::vector<std::string> marker_names = {};  // as the recording has them; empty for scans
};

struct CalibrationRecord {
  std::filesystem::path experiment;  // relative path from the run's folder
  bool usable = false;
  // Why it is not usable; of a usable record, that the fit was ended before it had converged.
  std::string message;
  // What the result does not contain or reach, in sentences without capital and full stop: a time
  // step that is not short enough, intervals without one of the errors of the model.
  std::vector<std::string> notes = {};
  // m, the standard deviations that whiten the residuals: of one coordinate of a marker, and of a
  // scanned point along the surface normal. 0 where there are no markers or no scans.
  double noise = 0, scan_noise = 0;
  double time_step = 0;   // s, time step of the simulation
  double step_error = 0;  // change of the prediction with half the step, in σ; 0: step given
  double start_rms = 0, rms = 0;            // whitened residuals, before and after the fit
  int predictions = 0;                      // number of simulations of all recordings
  std::vector<FittedParameter> parameters;  // model's, then the recordings'
  // The parameters of the model that are not fitted and are no settings: the density, then those of
  // the elasticity law and of the effects.
  std::vector<HeldParameter> held;
  std::vector<FittedRecording> recordings;
  std::vector<PriorConflict> prior_conflicts;
  // Known only after RunCalibration: they are not in the file.
  MeshRecord mesh;
  std::vector<std::string> mesh_notes;
};

// Whether some fitted recording shows markers or tracked points. `lacuna plan` makes variants of
// such recordings, and not of scans.
bool HasPlannableRecording(const CalibrationRecord& record);

// The rms length of the noise of a marker's position, m (RmsOfMarkerNoise). Nothing if a recording
// shows scans: the noise of their patches differs between recordings, so that no single number
// holds for all errors.
std::optional<double> RmsOfNoise(const CalibrationRecord& record);

// The name in files and reports, e.g. "traded off".
std::string DeterminationName(Determination determination);

// Infinite numbers become null.
nlohmann::json EstimateToJson(const ParameterEstimate& estimate);
// Throws nlohmann::json::exception.
ParameterEstimate EstimateFromJson(const nlohmann::json& value);

void WriteCalibrationFile(const CalibrationRecord& record, const std::filesystem::path& file);
// Throws InputError when the file is not a record of a calibration, or one in another format.
CalibrationRecord ReadCalibrationFile(const std::filesystem::path& file);
// Whether the file is a record in the format of another version of Lacuna.
bool IsCalibrationOfAnotherFormat(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_RECORD_CALIBRATION_RECORD_H_
