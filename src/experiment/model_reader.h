// The parts of a YAML file that describe a model: mesh, material, effects, time.
#ifndef LACUNA_EXPERIMENT_MODEL_READER_H_
#define LACUNA_EXPERIMENT_MODEL_READER_H_

#include <memory>
#include <string>
#include <vector>

#include "core/config.h"
#include "fem/model.h"
#include "fem/step_equation.h"
#include "meshing/tetrahedralize.h"
#include "scan/region.h"

namespace lacuna {

// `mesh: {radius_edge_ratio: 2.0, max_volume: 60 mm^3, order: 2}`; q and v of the paper.
struct MeshSettings {
  TetOptions tets;
  int order = 1;
};
MeshSettings ReadMeshSettings(const Config& config);

// `material: {law: …}` and `effects: [{type: …}]`, the material first.
EffectList ReadEffects(const Config& config);

// A force law of the user's own (docs/expression.md) that the model may lack.
struct OwnLaw {
  std::string name;  // by which it is ranked and added; letters, digits and underscores
  std::shared_ptr<const Effect> effect;
};
// `candidates: [{type: expression, name: magnet, …}]`, what a diagnosis tries besides the
// catalogue.
std::vector<OwnLaw> ReadCandidates(const Config& config, const Effect* material);

// Warnings about values far outside the range that the effect's card calls plausible.
std::vector<std::string> ImplausibleParameters(const EffectList& effects);

// `scheme: quasi_static | implicit_euler | bdf2 | two_step`.
TimeScheme ReadTimeScheme(const Config& config, const std::string& default_name);

// A number over time: linear between its points, constant before the first and after the last.
struct Profile {
  std::vector<double> times;   // s, ascending
  std::vector<double> values;  // dimensionless
  double At(double time) const;
};
// `profile: {times: [0 s, 0.5 s], values: [0, 1]}`; absent: 1 at all times.
Profile ReadProfile(const Config& config);

// The mesh nodes inside a region, as the model wants them.
Eigen::VectorXi NodesIn(const Region& region, const Eigen::Matrix3Xd& nodes);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_MODEL_READER_H_
