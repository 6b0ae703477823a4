// Reads the parts of a YAML file that describe a model: mesh, material, effects, time scheme. All
// functions throw InputError with the position of the key.
#ifndef LACUNA_EXPERIMENT_MODEL_READER_H_
#define LACUNA_EXPERIMENT_MODEL_READER_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/config.h"
#include "fem/model.h"
#include "fem/step_equation.h"
#include "meshing/tetrahedralize.h"
#include "scan/recorded_object.h"
#include "scan/region.h"

namespace lacuna {

// The settings `mesh: {radius_edge_ratio: 2.0, max_volume: 60 mm^3, order: 2}`. The first two are q
// and v of the paper; the order is that of the elements, 1 or 2. `min_dihedral_angle` and
// `preserve_surface` are described in meshing/tetrahedralize.h.
struct MeshSettings {
  TetOptions tets;
  int order = 1;
};
MeshSettings ReadMeshSettings(const Config& config);

// Reads `material: {law: …}` and `effects: [{type: …}]`. The material comes first. Effects that a
// model cannot have together are refused.
EffectList ReadEffects(const Config& config);

// Reads the list `effects` of a model that has `others` beside them, the material first: those of
// one recording beside those of its experiment. Refuses an effect that a model has only once if it
// is among `others` already, and one that cannot be combined with another.
EffectList ReadEffectsBeside(const EffectList& others, const Config& config);

// The gravity, m/s², of a model that has the effects of the list `effects` beside `others`; nothing
// for a model without. Refuses gravity in the list if an added mass among `others` has another
// weight (effects/free_fall.h).
std::optional<Eigen::Vector3d> ReadModelGravity(const Config& config, const EffectList& others);

// A user-defined force law (docs/expression.md) that the model may lack.
struct OwnLaw {
  std::string name;  // consists of letters, digits and underscores
  std::shared_ptr<const Effect> effect;
};
// Reads `candidates: [{type: expression, name: magnet, …}]`, the laws that a diagnosis tries
// besides the catalogue.
std::vector<OwnLaw> ReadCandidates(const Config& config, const Effect* material);

// One warning for each value far outside the range that is plausible in this body.
std::vector<std::string> ImplausibleParameters(const EffectList& effects, const BodyScale& body);

// A warning about the first effect with a negative Poisson's ratio; empty if there is none. Such
// materials exist, but a wrong sign is more frequent.
std::string AuxeticWarning(const EffectList& effects);

// A warning where the object was recorded under gravity, of which the model has none; empty
// otherwise. `gravity` in recording.yaml does not enter the model.
std::string GravityWarning(const RecordedObject& object, const EffectList& effects);

// Reads `scheme: quasi_static | implicit_euler | bdf2 | two_step`.
TimeScheme ReadTimeScheme(const Config& config, const std::string& default_name);

// A number as a function of time, linear between given points and constant outside of them.
struct Profile {
  std::vector<double> times;   // s, ascending
  std::vector<double> values;  // dimensionless
  double At(double time) const;
};
// Reads `profile: {times: [0 s, 0.5 s], values: [0, 1]}`; without it the profile is 1 at all times.
Profile ReadProfile(const Config& config);

// The nodes of the mesh in a region, as SelectNodes gives them.
Eigen::VectorXi NodesIn(const Region& region, const TetMesh& mesh);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_MODEL_READER_H_
