#include "trials/trial_simulation.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/atomic_file.h"
#include "effects/attached_mass.h"
#include "effects/catalogue.h"
#include "effects/effect_text.h"
#include "effects/gravity.h"
#include "effects/standard_cards.h"
#include "fem/prediction.h"
#include "fem/prescribed_force.h"
#include "geometry/rounded_box.h"
#include "meshing/tetrahedralize.h"
#include "prediction/reading_times.h"
#include "trials/case_files.h"
#include "trials/clamp_motion.h"
#include "trials/trial_load_cell.h"
#include "trials/trial_recording.h"

namespace lacuna {
namespace {

constexpr double kRelease = 0.1037;   // s
constexpr double kFitUntil = 0.451;   // s
constexpr double kRoughStep = 0.002;  // s

Eigen::VectorXi NodesBetween(const Eigen::Matrix3Xd& nodes, double low, double high) {
  std::vector<int> chosen;
  for (Eigen::Index i = 0; i < nodes.cols(); ++i)
    if (nodes(0, i) >= low && nodes(0, i) <= high) chosen.push_back(static_cast<int>(i));
  return Eigen::Map<Eigen::VectorXi>(chosen.data(), static_cast<Eigen::Index>(chosen.size()));
}

// The true model: the material and the effects of every model, except those that are hidden by
// their absence from it, those that the model of this case has too, and the hidden effects.
std::vector<std::shared_ptr<const Effect>> TrueEffects(const TrialCase& trial) {
  std::vector<std::shared_ptr<const Effect>> effects = {
      MakeEffect(NeoHookeanCard().type,
                 {{"young_modulus", trial.young_modulus}, {"poisson_ratio", trial.poisson_ratio}})};
  if (!trial.Hides(StiffnessDampingCard().type))
    effects.push_back(
        MakeEffect(StiffnessDampingCard().type, {{"beta", trial.damping},
                                                 {"young_modulus", trial.young_modulus},
                                                 {"poisson_ratio", trial.poisson_ratio}}));
  if (!trial.Hides(GravityCard().type)) effects.push_back(MakeGravity({0, 0, -kStandardGravity}));
  for (const ModelledEffect& modelled : trial.modelled)
    effects.push_back(MakeEffect(modelled.type, modelled.parameters));
  for (const HiddenEffect& hidden : trial.hidden) {
    if (IsLaw(hidden))
      effects.front() = MakeHidden(hidden);
    else
      effects.push_back(MakeHidden(hidden));
  }
  return effects;
}

std::vector<double> FrameTimes(const TrialCase& trial, int recording) {
  std::vector<double> times = StampedTimes();
  if (const double deviation = trial.Disturbance().time_deviation; deviation > 0)
    for (size_t f = 0; f < times.size(); ++f)
      times[f] += deviation * std::clamp(Gauss(trial, 40 + recording, f, 0), -2.0, 2.0);
  return times;
}

// What is done in the recordings with which a case comes.
TrialProcedure ProcedureOf(const TrialCase& trial, int recording) {
  return {FrameTimes(trial, recording),
          [recording](double time) { return ClampMotionAt(recording, time).Place(); },
          trial.hold_forces[static_cast<size_t>(recording)],
          {},
          CellTimes(trial, recording, StampedTimes())};
}

// The entry of a parameter under fit.parameters.
std::string Fitted(const TrialCase& trial, const std::string& name) {
  std::string entry = "{name: " + name;
  for (const TrialPrior& prior : trial.priors)
    if (prior.name == name)
      entry += fmt::format(", mean: {0} {2}, deviation: {1} {2}", prior.mean, prior.deviation,
                           prior.unit);
  return entry + "}";
}

}  // namespace

TrueMotion SimulateTruth(const TrialCase& trial, const TrialProcedure& procedure, bool rough) {
  // A clamp that extends further holds more of the bar, so that its free part is shorter.
  Eigen::Vector3d size = trial.true_size;
  size[0] -= trial.clamp_error;
  const Eigen::Vector3d centre(trial.clamp_error + 0.5 * size[0], 0, 0);
  const MeshResult mesh =
      MeshTetrahedra(RoundedBox(centre, size, 0, 0.006),
                     {.radius_edge_ratio = 1.7,
                      .max_volume = rough ? trial.element_volume : trial.true_element_volume,
                      .preserve_surface = false,
                      .order = 2});
  if (!mesh.IsUsable()) throw SimulationFailure(trial.name + ": " + mesh.message);
  Model model;
  model.body = std::make_shared<const Body>(MakeBody(mesh.mesh, kTrialDensity));
  model.effects = TrueEffects(trial);
  if (procedure.weight) {
    const Eigen::Vector3d gravity =
        GravityOf(model.effects).value_or(Eigen::Vector3d(Eigen::Vector3d::Zero()));
    model.effects.push_back(MakeAttachedMass(procedure.weight->mass, procedure.weight->place,
                                             procedure.weight->radius, gravity));
  }
  const Eigen::Matrix3Xd& nodes = model.body->mesh.nodes;
  const Eigen::VectorXi clamped = NodesBetween(nodes, -1, trial.clamp_error + kTrialFace);
  const Eigen::Matrix3Xd rest = nodes(Eigen::all, clamped);
  model.grips = {{clamped, [rest, &procedure](double time) -> Eigen::Matrix3Xd {
                    return procedure.clamp(time) * rest;
                  }}};
  const Eigen::VectorXd share = BoundaryShares(
      *model.body, NodesBetween(nodes, trial.true_size[0] - kTrialFace, trial.true_size[0] + 1));
  PredictionOptions options;
  options.start_time = kRelease;
  options.time_step = rough ? kRoughStep : trial.true_step;
  options.held_force.resize(3 * share.size());
  for (Eigen::Index i = 0; i < share.size(); ++i)
    options.held_force.segment<3>(3 * i) = share[i] * procedure.hold_force;
  if (const Eigen::Matrix3Xd moved = procedure.clamp(kRelease) * nodes; moved != nodes)
    options.held_guess = moved.reshaped();
  if (!procedure.cell_times.empty()) options.reactions = {{0, std::nullopt}};
  const std::vector<ReadingTime> visits = ReadingTimesOf(procedure.times, {procedure.cell_times});
  TrueMotion motion{model.body, {}, {}};
  motion.forces.resize(3, static_cast<Eigen::Index>(procedure.cell_times.size()));
  const PredictionSummary summary =
      Predict(model, options, TimesOf(visits), {}, [&](int index, const PredictedState& state) {
        const ReadingTime& visit = visits[static_cast<size_t>(index)];
        if (visit.shows_frame)
          motion.positions.emplace_back(state.position.reshaped(3, nodes.cols()));
        else
          motion.forces.col(static_cast<Eigen::Index>(visit.frame)) = state.reaction;
      });
  if (!summary.IsUsable())
    throw SimulationFailure(
        fmt::format("{}: the truth cannot be simulated: {}", trial.name, summary.message));
  return motion;
}

void SimulateCase(const TrialCase& trial, const std::filesystem::path& folder, bool rough) {
  MakeFolder(folder);
  std::string known,
      fitted = Fitted(trial, "young_modulus") + ", " + Fitted(trial, "poisson_ratio");
  const std::string& damping = StiffnessDampingCard().type;
  if (!trial.Hides(damping)) {
    known += fmt::format("  - {{type: {}, beta: 0.5 ms}}\n", damping);
    fitted += ", " + Fitted(trial, damping + ".beta");
  }
  const std::string& gravity = GravityCard().type;
  if (!trial.Hides(gravity))
    known += fmt::format("  - {{type: {}, acceleration: [0, 0, {} m/s^2]}}\n", gravity,
                         -kStandardGravity);
  for (const ModelledEffect& modelled : trial.modelled) {
    std::map<std::string, double> start = modelled.parameters;
    for (const auto& [name, value] : modelled.starts) {
      start[name] = value;
      fitted += ", " + Fitted(trial, modelled.type + "." + name);
    }
    known += "  - " + FormatEffect(*MakeEffect(modelled.type, start)).value() + "\n";
  }
  const double wrong_volume = trial.Disturbance().element_volume;
  std::string yaml = fmt::format(
      "schema_version: 1\nname: {}\nmesh: {{max_volume: {} m^3, order: 2, preserve_surface: "
      "false}}\n"
      "material: {{law: {}, young_modulus: 0.12 MPa, poisson_ratio: 0.42}}\n"
      "effects:{}\nfit: {{parameters: [{}]}}\n"
      "{}{}recordings:\n",
      trial.name, wrong_volume > 0 ? wrong_volume : trial.element_volume, NeoHookeanCard().type,
      known.empty() ? " []" : "\n" + known, fitted,
      rough ? fmt::format("motion: {{time_step: {} s}}\n", kRoughStep) : "",
      trial.is_scanned ? fmt::format("scan: {{shape_deviation: {} m}}\n", kTrialShapeError)
                       : fmt::format("place_deviation: {} m\n", 2 * kTrialPlaceError));
  for (int r = 0; r < trial.recordings; ++r) {
    const std::string name = fmt::format("recording_{}", r + 1);
    WriteRecording(trial, r, SimulateTruth(trial, ProcedureOf(trial, r), rough), folder / name);
    yaml += fmt::format(
        "  - recording: {}\n    fit_until: {} s\n    hold:\n      release: {} s\n      region: "
        "{{half_space: {{point: [{} m, 0 m, 0 m], normal: [1, 0, 0]}}}}\n",
        name, kFitUntil, kRelease, trial.size[0] - kTrialFace);
  }
  WriteFileAtomically(folder / kExperimentFile, yaml);
}

}  // namespace lacuna
