// An experiment that predicts: a model with known loads, measured grips and everything else
// simulated, against one or several recordings of the same object. docs/prediction.md lists the
// keys.
#ifndef LACUNA_PREDICTION_PREDICTION_STUDY_H_
#define LACUNA_PREDICTION_PREDICTION_STUDY_H_

#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/config.h"
#include "experiment/model_reader.h"
#include "experiment/scan_frames.h"
#include "experiment/scan_settings.h"
#include "fem/model.h"
#include "fem/step_equation.h"
#include "fit/calibration.h"
#include "geometry/surface_patches.h"
#include "scan/recording.h"

namespace lacuna {

// The object is held at rest until then, by a force of unknown size and direction on this region.
struct Hold {
  Region region;
  double release = 0;  // s, in the recording's time
};

struct PredictedRecording {
  std::string name;
  Recording recording;
  std::shared_ptr<const ScanFrames> scans;  // its points; null: markers, or points that are tracked
  std::vector<int> frames;                  // ascending
  bool fitted = true;                       // false: only predicted
  // Frames after this time are held out: predicted, not fitted. s
  double fit_until = std::numeric_limits<double>::infinity();
  std::optional<Hold> hold;
  // By how much the recording's clock may differ from the model's, s (prior); 0: not at all.
  double clock_deviation = 0;
  // By how much its measuring frame may be shifted, m, and turned, rad, against the fixture
  // (priors, of each axis); 0: not at all.
  double shift_deviation = 0, turn_deviation = 0;
  EffectList effects;  // of this recording only, e.g. a hung mass

  // Until then the object is at rest, s.
  double StartTime() const { return hold ? hold->release : recording.times[frames.front()]; }
};

// A number of the model that may be fitted, and what is known of it before.
struct ModelParameter {
  // The effects that have it, by their place in PredictionStudy::effects, and its index on their
  // cards. There are several where an effect shares a modulus with the material.
  struct Place {
    size_t effect = 0;
    int index = 0;
    bool operator==(const Place&) const = default;
  };
  std::vector<Place> places;
  CalibratedParameter prior;  // name "young_modulus" of the material, "gravity.acceleration_z"
  std::string unit;           // SI
};
// All of them, settings excepted; bounds and priors as their cards say.
std::vector<ModelParameter> ModelParameters(const EffectList& effects);
// The same effects with these values of the parameters (SI, in the order of `parameters`; further
// entries are not read).
EffectList WithValues(const EffectList& effects, const std::vector<ModelParameter>& parameters,
                      const Eigen::VectorXd& values);

struct PredictionStudy {
  std::filesystem::path file;  // the experiment
  std::string name;
  std::filesystem::path output;
  MeshSettings mesh;
  int sheet_layers = 1;
  double density = 0;  // kg/m³
  EffectList effects;  // the material first
  TimeScheme scheme = TimeScheme::kTwoStep;
  double time_step = 0.005;         // s; of a quasi-static one at most
  bool chooses_time_step = false;   // the fit shortens it as far as the recordings ask for
  double noise = 0;                 // m, of a marker's coordinate; 0: estimated from the recordings
  bool noise_is_estimated = false;  // it has been
  // m, of a marker's place on the object: it adds to all frames alike.
  double place_deviation = 0.001;
  ScanSettings scan;
  // Into which scans divide the surface; empty: chosen on the mesh. Given where predictions with
  // different meshes are compared.
  SurfacePatches patches;
  std::vector<ModelParameter> fitted;
  std::vector<OwnLaw> candidates;  // that a diagnosis tries besides the catalogue
  std::vector<PredictedRecording> recordings;
  nlohmann::json configuration;  // resolved, SI
};

// Of the frames that are used, s, of the recording where it is longest.
double Duration(const PredictionStudy& study);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_PREDICTION_STUDY_H_
