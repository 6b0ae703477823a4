// An experiment with a prediction. The external loads are known and the motion of the grips is
// measured; everything else is simulated and compared with one or several recordings of the same
// object. docs/prediction.md lists the keys.
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
#include "prediction/simulated_cell.h"
#include "scan/recording.h"

namespace lacuna {

// Until its release the object is held at rest by a force of unknown magnitude and direction on a
// region.
struct Hold {
  Region region;
  double release = 0;  // s, in the recording's time
  // N, with which a fit starts and a simulation holds; nothing: a fit starts with 0.
  std::optional<Eigen::Vector3d> force = {};
};

// One recording of the study, and how the prediction is compared with it.
struct PredictedRecording {
  std::string name;
  Recording recording;
  std::shared_ptr<const ScanFrames> scans;  // null for markers or tracked points
  std::vector<int> frames;                  // frames that are used, ascending
  bool fitted = true;                       // false where it is only predicted
  // Frames after this time, s, are held out: they are predicted but not fitted.
  double fit_until = std::numeric_limits<double>::infinity();
  std::optional<Hold> hold;
  // Standard deviation (prior) of the difference between the recording's clock and the model's, s;
  // 0 where they agree.
  double clock_deviation = 0;
  // Standard deviations (priors, for each axis) of the translation, m, and the rotation, rad,
  // between the recording's coordinate system and the fixture; 0 where they agree.
  double shift_deviation = 0, turn_deviation = 0;
  EffectList effects;  // effects in this recording only, such as an attached mass
  // The errors of its load cells where it is played, one for each reading; empty: none. A fit does
  // not know them.
  std::vector<SimulatedCell> simulated_cells = {};

  bool ShowsScans() const { return scans != nullptr; }
  // Whether a frame is fitted. The other used frames are held out.
  bool IsFitted(int frame) const { return fitted && recording.times[frame] <= fit_until; }
  // The used frames that are fitted, ascending; none where the recording is only predicted.
  std::vector<int> FittedFrames() const;
  // The time, s, until which the object is at rest.
  double StartTime() const { return hold ? hold->release : recording.times[frames.front()]; }
};
// The regions of its object and of its hold.
std::vector<Region*> RegionsIn(PredictedRecording* item);

// A parameter of the model that may be fitted, with its prior.
struct ModelParameter {
  // An effect that has the parameter, by its index in PredictionStudy::effects, and the parameter's
  // index on the effect's card. The first is the one that the parameter is named after. There are
  // several where effects share a parameter of the material or gravity, which may be a setting of
  // theirs (prediction/setting_derivative.h).
  struct Place {
    size_t effect = 0;
    int index = 0;
    bool operator==(const Place&) const = default;
  };
  std::vector<Place> places;
  CalibratedParameter prior;  // named "young_modulus" (material) or "gravity.acceleration_z"
  std::string unit;           // SI unit
};
// All parameters of these effects except settings, with the bounds and priors of their cards, whose
// ranges are those in a body of this scale. An effect shares a parameter of the material (the first
// effect) if it has one of the same name and value whose value it takes from the material where the
// user omits it, and gravity if it adds mass that has the same gravity.
std::vector<ModelParameter> ModelParameters(const EffectList& effects, const BodyScale& body);
// The effect that a parameter belongs to; of effects that share it, the first.
const Effect& EffectOf(const ModelParameter& parameter, const EffectList& effects);
// Whether a parameter is the density of the body, which the experiment states beside the effects.
bool IsDensity(const ModelParameter& parameter, const EffectList& effects);
// The effects with these values of the parameters (SI, in the order of `parameters`; further
// entries are not read).
EffectList WithValues(const EffectList& effects, const std::vector<ModelParameter>& parameters,
                      const Eigen::VectorXd& values);

struct PredictionStudy {
  std::filesystem::path file;  // the experiment's YAML file
  std::string name;
  std::filesystem::path output;
  MeshSettings mesh;
  int sheet_layers = 1;
  double density = 0;  // kg/m³
  // Relative standard deviation (prior) of the density; 0: it is exact. Otherwise the reader
  // appends the density to `fitted` and its effect to `effects` (effects/uniform_density.h);
  // IsDensity() finds it.
  double density_deviation = 0;
  EffectList effects;  // the material first
  TimeScheme scheme = TimeScheme::kTwoStep;
  double time_step = 0.005;         // s; quasi-static steps may be shorter
  bool chooses_time_step = false;   // the fit shortens the step as far as the recordings require
  double noise = 0;                 // m, σ of a marker's coordinate; 0: estimate it
  bool noise_is_estimated = false;  // whether `noise` is an estimate
  // m, σ of a marker's place on the object, an error that is the same in all frames.
  double place_deviation = 0.001;
  bool place_deviation_is_given = false;
  double size_deviation = 0.003;  // relative, σ of each dimension of the object: 0.05 mm of 17 mm
  // The squared misfit, σ², that effects have removed which a diagnosis has added to the model. The
  // next diagnosis judges what the model leaves by it.
  double explained_misfit = 0;
  ScanSettings scan;
  // The patches of the surface in which scans are averaged; empty: chosen on the mesh. They are
  // given where predictions with different meshes are compared.
  SurfacePatches patches;
  std::vector<ModelParameter> fitted;
  std::vector<OwnLaw> candidates;  // user-defined laws, which a diagnosis tries too
  std::vector<PredictedRecording> recordings;
  nlohmann::json configuration;  // with defaults resolved, in SI units
};

// σ of the places of a recording's points on the object, m. The places of tracked points are read
// off an undeformed frame, so that they have its noise (m, σ) unless place_deviation is given.
double PlaceDeviation(const PredictionStudy& study, const PredictedRecording& item, double noise);

// The scale of the model's body: the modulus of its material, its density, and the size of the
// first recording's object, whose shape it has.
BodyScale ScaleOf(const PredictionStudy& study);

// The time that the used frames span, s, in the longest recording.
double Duration(const PredictionStudy& study);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_PREDICTION_STUDY_H_
