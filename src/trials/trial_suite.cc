#include "trials/trial_suite.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "calibration/calibration_problem.h"
#include "calibration/linear_misfit.h"
#include "core/atomic_file.h"
#include "core/random_bits.h"
#include "diagnosis/grip_motions.h"
#include "diagnosis/model_change.h"
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/thresholds.h"
#include "effects/catalogue.h"
#include "effects/standard_cards.h"
#include "prediction/predicted_body.h"
#include "prediction/prediction_study_reader.h"
#include "trials/case_files.h"
#include "trials/trial_load_cell.h"
#include "trials/trial_simulation.h"

namespace lacuna {
namespace {

// Number of draws of a case until the detectable size of its effect is plausible.
constexpr int kMostAttempts = 8;

// Hides one more effect in the case.
void Hide(const std::string& type, double factor, TrialCase* trial) {
  trial->hidden.push_back(
      DrawHidden(type, *trial, RandomBits({trial->seed, trial->hidden.size()})));
  trial->hidden.back().factor = factor;
}

// The same case with the next seed.
TrialCase DrawnAgain(const TrialCase& trial) {
  TrialCase again = DrawCase(trial.name, trial.group, RandomBits({trial.seed, 1}), trial.recordings,
                             trial.is_scanned, trial.nuisance);
  for (const HiddenEffect& hidden : trial.hidden) Hide(hidden.type, hidden.factor, &again);
  if (trial.load_cell) again.load_cell = DrawLoadCell(again.seed, 1);
  return again;
}

// The change of the residuals, m, that the hidden effect causes at the size that was drawn.
Eigen::VectorXd ChangeBy(const HiddenEffect& hidden, const CalibrationProblem& problem,
                         const Eigen::VectorXd& values, const LinearisedMisfit& misfit) {
  CandidateEffect candidate;
  candidate.type = hidden.type;
  candidate.effect = MakeHidden(hidden);
  candidate.replaces_material = IsLaw(hidden);
  const PredictionStudy study = WithCandidate(problem.WithEstimatedNoise(), candidate);
  const LinearisedMisfit with = CalibrationProblem(study, problem.body()->mesh)
                                    .Linearise(values, {.correspondences = &misfit});
  if (!with.usable) throw SimulationFailure(hidden.type + ": " + with.message);
  return with.residual - misfit.residual;
}

// The true values of the fitted parameters, in the same order.
Eigen::VectorXd TrueValues(const TrialCase& trial, const TrialCase& without,
                           const PredictionStudy& study, const CalibrationProblem& problem) {
  Eigen::VectorXd values = problem.Start();
  values[0] = trial.young_modulus;
  values[1] = trial.poisson_ratio;
  const Eigen::Index of_body = static_cast<Eigen::Index>(study.fitted.size());
  if (!without.Hides(StiffnessDampingCard().type)) values[2] = trial.damping;
  const Eigen::Index of_recording = trial.load_cell ? 4 : 3;
  CHECK_EQ(values.size(), of_body + of_recording * trial.recordings);
  for (int r = 0; r < trial.recordings; ++r) {
    auto own = values.segment(of_body + of_recording * r, of_recording);
    own.head<3>() = trial.hold_forces[static_cast<size_t>(r)];
    if (trial.load_cell) own[3] = CellDelay(trial, r);
  }
  return values;
}

// The directions of the sizes of the hidden effect, at its null value.
std::vector<MisfitDirection> SizeDirections(const HiddenEffect& hidden) {
  HiddenEffect none = hidden;
  const EffectCard& card = *FindEntry(hidden.type)->card;
  for (size_t k = 0; k < hidden.amplitude.size(); ++k)
    none.parameters[hidden.amplitude[k]] = card.parameters[k].null_value;
  const std::shared_ptr<const Effect> effect = MakeHidden(none);
  std::vector<MisfitDirection> directions;
  for (size_t k = 0; k < hidden.amplitude.size(); ++k)
    directions.push_back({.perturbation = {.effect = effect, .parameter = static_cast<int>(k)}});
  return directions;
}

// The nuisances of the measurement from which a hidden effect must be distinguishable.
std::vector<NuisanceCandidate> CaseNuisances(const CalibrationProblem& problem,
                                             const Eigen::VectorXd& values,
                                             const LinearisedWithGrips& linearised) {
  const LinearisedMisfit& misfit = linearised.misfit;
  const Eigen::MatrixXd grip_columns = linearised.OfGrips();
  std::vector<NuisanceCandidate> nuisances = GripNuisances(linearised.grips, grip_columns);
  for (NuisanceCandidate& nuisance :
       ModelNuisances({problem, values, misfit, linearised.grips, grip_columns}))
    nuisances.push_back(std::move(nuisance));
  for (NuisanceCandidate& nuisance : RecordingNuisances(problem, misfit, misfit.residual))
    nuisances.push_back(std::move(nuisance));
  std::erase_if(nuisances, [](const NuisanceCandidate& nuisance) {
    return !nuisance.card.trial.limits_detection;
  });
  return nuisances;
}

// The smallest multiple of a hidden effect, as drawn, that is detectable above the noise of its
// case and that the nuisances of the measurement (grip, dimensions, clock, drift of the camera,
// force of the hand, discretisation) cannot explain. Infinity if they explain all of it.
double Detectable(const TrialCase& trial, const HiddenEffect& hidden,
                  const std::filesystem::path& folder) {
  TrialCase without = trial;
  without.hidden.clear();
  if (FindEntry(hidden.type)->card->trial.is_in_every_model) {
    // The model must lack the effect. At size zero, its absence is no error of the model.
    without.hidden.push_back(hidden);
    for (const std::string& name : hidden.amplitude) without.hidden[0].parameters[name] = 0;
  }
  SimulateCase(without, folder, /*rough=*/true);
  const PredictionStudy study = ReadPredictionStudy(Config::Load(folder / kExperimentFile));
  const ReferenceBody reference = MakeReferenceBody(study);
  const CalibrationProblem problem(study, reference.mesh);
  const Eigen::VectorXd values = TrueValues(trial, without, study, problem);
  LinearisedWithGrips linearised = LineariseWithGrips(problem, values, SizeDirections(hidden));
  LinearisedMisfit& misfit = linearised.misfit;
  if (!misfit.usable) throw SimulationFailure(trial.name + ": " + misfit.message);
  // The noise of a depth camera is that along its rays and stays as estimated.
  if (!trial.is_scanned)
    for (LinearisedMisfit::Part& part : misfit.parts)
      if (part.IsOfPoints()) part.errors.noise = trial.noise;
  Eigen::MatrixXd columns = misfit.jacobian.leftCols(linearised.parameters);
  std::vector<LinearPrior> priors = PriorsAbout(problem.parameters(), values);
  for (const NuisanceCandidate& nuisance : CaseNuisances(problem, values, linearised))
    AppendColumns(nuisance.columns, nuisance.priors, &columns, &priors);
  const int own = static_cast<int>(columns.cols());
  Eigen::VectorXd change;
  if (hidden.amplitude.empty()) {
    change = ChangeBy(hidden, problem, values, misfit);
  } else {
    Eigen::VectorXd amount(static_cast<Eigen::Index>(hidden.amplitude.size()));
    for (size_t k = 0; k < hidden.amplitude.size(); ++k)
      amount[static_cast<Eigen::Index>(k)] = hidden.parameters.at(hidden.amplitude[k]);
    change = linearised.OfDirections() * amount;
  }
  AppendColumns(change, {LinearPrior{}}, &columns, &priors);
  const LinearGaussianModel model(
      WhitenedRows(misfit.residual, misfit, {.correlation_time = trial.noise_correlation_time}),
      WhitenedRows(columns, misfit, {.correlation_time = trial.noise_correlation_time}), priors);
  std::vector<int> taken(own);
  std::iota(taken.begin(), taken.end(), 0);
  const double remaining = model.Remaining(taken, {own}, {own}, 1)(0, 0);
  return remaining > 0 ? kThresholds.ranking.detectable_deviations / std::sqrt(remaining)
                       : std::numeric_limits<double>::infinity();
}

bool IsPlausible(const HiddenEffect& hidden) {
  const EffectCard& card = *FindEntry(hidden.type)->card;
  for (size_t k = 0; k < hidden.amplitude.size(); ++k) {
    const double value = hidden.parameters.at(hidden.amplitude[k]);
    if (value < card.parameters[k].plausible_min || value > card.parameters[k].plausible_max)
      return false;
  }
  return true;
}

void SimulateAndSeal(const TrialCase& trial, const std::filesystem::path& folder) {
  SimulateCase(trial, folder);
  if (trial.group != TrialGroup::kRemoved) return;
  std::string types;
  for (const HiddenEffect& hidden : trial.hidden) types += hidden.type + "\n";
  WriteFileAtomically(folder / kWithoutFile, types);
}

// Determines the sizes of the hidden effects and simulates the case. Returns why the case cannot be
// made as it was drawn, empty on success. Throws InputError where another draw would not help.
std::string SizeAndSimulate(TrialCase* trial, const std::filesystem::path& folder) {
  try {
    for (HiddenEffect& hidden : trial->hidden) {
      const double size = hidden.factor * Detectable(*trial, hidden, folder);
      for (const std::string& name : hidden.amplitude) hidden.parameters[name] *= size;
      const bool is_seen = !hidden.amplitude.empty() || size <= 1;
      if (!std::isfinite(size) || !IsPlausible(hidden) || !is_seen)
        return fmt::format("{} would have to be {:g} times its unit", hidden.type, size);
    }
    SimulateAndSeal(*trial, folder);
  } catch (const SimulationFailure& problem) {
    return problem.what();
  }
  return "";
}

// Why no case can hide the effect of this type; empty if one can.
std::string WhyNotHidden(const std::string& type) {
  const CatalogueEntry* entry = FindEntry(type);
  if (entry == nullptr) return fmt::format("no effect is called \"{}\"", type);
  if (entry->make == nullptr)
    return fmt::format("\"{}\" cannot be drawn, because numbers alone do not describe it", type);
  if (type == NeoHookeanCard().type)
    return fmt::format("\"{}\" is the elasticity law of every model", type);
  return "";
}

}  // namespace

std::vector<std::string> ReadEffectTypes(const Config& config, const std::string& key) {
  const std::vector<std::string> types = config.Texts(key);
  for (size_t k = 0; k < types.size(); ++k) {
    if (std::find(types.begin(), types.begin() + static_cast<std::ptrdiff_t>(k), types[k]) !=
        types.begin() + static_cast<std::ptrdiff_t>(k))
      config.FailAtItem(key, k, fmt::format("\"{}\" is listed twice", types[k]));
    const std::string why = WhyNotHidden(types[k]);
    if (why.empty()) continue;
    std::vector<std::string> possible;
    for (const CatalogueEntry& entry : Catalogue())
      if (WhyNotHidden(entry.card->type).empty()) possible.push_back(entry.card->type);
    config.FailAtItem(key, k,
                      fmt::format("{}; expected one of: {}", why, fmt::join(possible, ", ")));
  }
  return types;
}

TrialSuite ReadTrialSuite(const Config& config) {
  TrialSuite suite;
  config.Integer("schema_version", 1, 1);
  config.Text("name");
  constexpr int kMost = 1'000'000;
  suite.seed = static_cast<uint64_t>(config.Integer("seed", 0, kMost));
  suite.controls = config.Integer("controls", 0, kMost, 0);
  suite.hard_controls = config.Integer("hard_controls", 0, kMost, 0);
  suite.pairs = config.Integer("pairs", 0, kMost, 0);
  suite.load_cells = config.Number("load_cells", Bounds{0, 1}, 0);
  suite.is_scanned =
      config.Choice<bool>("seen_by", {{"markers", false}, {"scanner", true}}, "markers");
  suite.effects = ReadEffectTypes(config, "effects");
  suite.removed = ReadEffectTypes(config, "removed");
  suite.factors = config.Integers("factors", 1);
  suite.recordings = config.Integers("recordings", 1);
  for (size_t k = 0; k < suite.recordings.size(); ++k)
    if (suite.recordings[k] > 2) config.FailAtItem("recordings", k, "a case has 1 or 2 recordings");
  if (suite.pairs > 0 && suite.effects.size() < 2)
    config.Fail("pairs",
                "two effects are hidden at once, so that `effects` must list at least two");
  if (suite.factors.empty()) suite.factors = {1, 2, 4};
  if (suite.recordings.empty()) suite.recordings = {1, 2};
  config.RefuseUnknownKeys();
  return suite;
}

std::vector<TrialCase> CasesOf(const TrialSuite& suite) {
  std::vector<TrialCase> cases;
  const auto add = [&](TrialGroup group, const std::string& what, int recordings,
                       const std::string& nuisance) -> TrialCase& {
    const size_t number = cases.size();
    const std::string name =
        fmt::format("{:04}-{}{}-{}rec", number, TrialGroupName(group), what, recordings);
    return cases.emplace_back(DrawCase(name, group, RandomBits({suite.seed, number}), recordings,
                                       suite.is_scanned, nuisance));
  };
  const auto hide = [&](TrialGroup group, const std::vector<std::string>& types, double factor,
                        int recordings) {
    TrialCase& trial =
        add(group, fmt::format("-{}-{:g}x", fmt::join(types, "-"), factor), recordings, "");
    for (const std::string& type : types) Hide(type, factor, &trial);
  };
  const size_t counts = suite.recordings.size();
  for (int k = 0; k < suite.controls; ++k)
    add(TrialGroup::kControl, "", suite.recordings[k % counts], "");
  const std::vector<NuisanceTrial> disturbances = NuisanceControls();
  for (int k = 0; k < suite.hard_controls; ++k) {
    const std::string& nuisance = disturbances[(k / counts) % disturbances.size()].control;
    add(TrialGroup::kHardControl, "-" + nuisance, suite.recordings[k % counts], nuisance);
  }
  const int largest = *std::max_element(suite.factors.begin(), suite.factors.end());
  for (const std::string& type : suite.removed)
    for (const int recordings : suite.recordings)
      hide(TrialGroup::kRemoved, {type}, largest, recordings);
  for (int k = 0; k < suite.pairs; ++k) {
    const uint64_t draw = RandomBits({suite.seed, 7, static_cast<uint64_t>(k)});
    const size_t count = suite.effects.size();
    const size_t first = draw % count, second = (first + 1 + (draw >> 20) % (count - 1)) % count;
    hide(TrialGroup::kPair, {suite.effects[first], suite.effects[second]}, largest,
         suite.recordings.back());
  }
  for (const int factor : suite.factors)
    for (const std::string& type : suite.effects)
      for (const int recordings : suite.recordings)
        hide(TrialGroup::kOneEffect, {type}, factor, recordings);
  for (TrialCase& trial : cases) {
    trial.load_cell = DrawLoadCell(trial.seed, suite.load_cells);
    if (trial.load_cell) trial.name += "-cell";
  }
  return cases;
}

bool MakeCase(TrialCase trial, const std::filesystem::path& folder) {
  const std::filesystem::path own = folder / trial.name;
  if (std::filesystem::exists(own / kSkippedFile)) return false;
  MakeFolder(own);
  if (std::filesystem::exists(own / kTruthFile)) {
    // If only the truth was kept, the recordings are simulated again.
    if (!std::filesystem::exists(own / kExperimentFile)) SimulateAndSeal(ReadCase(own), own);
    return true;
  }
  std::string reasons;
  for (int attempt = 1;; ++attempt) {
    const std::string reason = SizeAndSimulate(&trial, own);
    if (reason.empty()) break;
    reasons += reason + "\n";
    if (trial.hidden.empty() || attempt == kMostAttempts) {
      WriteFileAtomically(own / kSkippedFile, reasons);
      return false;
    }
    trial = DrawnAgain(trial);
  }
  WriteCase(trial, own);
  return true;
}

bool MakeTrials(const TrialSuite& suite, const std::filesystem::path& folder, int workers) {
  const std::vector<TrialCase> cases = CasesOf(suite);
  MakeFolder(folder);
  std::vector<std::filesystem::path> folders;
  for (const TrialCase& trial : cases) folders.push_back(folder / trial.name);
  return ShareCases(folders, "", {.workers = workers},
                    [&](size_t k) { MakeCase(cases[k], folder); });
}

}  // namespace lacuna
