#include "trials/trial_suite.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/atomic_file.h"
#include "core/claim.h"
#include "core/error.h"
#include "core/workers.h"
#include "diagnosis/candidates.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/grip_motions.h"
#include "diagnosis/model_change.h"
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/thresholds.h"
#include "effects/catalogue.h"
#include "effects/stiffness_damping.h"
#include "experiment/reference_body.h"
#include "prediction/predicted_body.h"
#include "prediction/prediction_study_reader.h"
#include "scan/random_bits.h"
#include "trials/trial_load_cell.h"
#include "trials/trial_simulation.h"

namespace lacuna {
namespace {

// Number of draws of a case until the detectable size of its effect is plausible.
constexpr int kMostAttempts = 8;

TrialCase DrawEffectCase(const std::string& name, const std::string& group,
                         const std::vector<std::string>& types, double factor, int recordings,
                         bool is_scanned, uint64_t seed) {
  TrialCase trial = DrawCase(name, group, seed, recordings, is_scanned, "");
  for (const std::string& type : types) {
    trial.hidden.push_back(DrawHidden(type, trial, RandomBits({seed, trial.hidden.size()})));
    trial.hidden.back().factor = factor;
  }
  return trial;
}

TrialCase EffectCase(const TrialSuite& suite, const std::string& group,
                     const std::vector<std::string>& types, double factor, int recordings,
                     size_t number) {
  std::string name = fmt::format("{:04}-{}", number, group);
  for (const std::string& type : types) name += "-" + type;
  return DrawEffectCase(fmt::format("{}-{:g}x-{}rec", name, factor, recordings), group, types,
                        factor, recordings, suite.is_scanned, RandomBits({suite.seed, number}));
}

// The same case with the next seed.
TrialCase DrawnAgain(const TrialCase& trial) {
  std::vector<std::string> types;
  for (const HiddenEffect& hidden : trial.hidden) types.push_back(hidden.type);
  TrialCase again = DrawEffectCase(trial.name, trial.group, types, trial.hidden.front().factor,
                                   trial.recordings, trial.is_scanned, RandomBits({trial.seed, 1}));
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
  const LinearisedMisfit with =
      CalibrationProblem(study, problem.body()->mesh).Linearise(values, false, {}, &misfit);
  if (!with.usable) throw InputError(hidden.type + ": " + with.message);
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
// `grip_columns` are the columns of the directions of `grips`.
std::vector<NuisanceCandidate> CaseNuisances(const CalibrationProblem& problem,
                                             const Eigen::VectorXd& values,
                                             const LinearisedMisfit& misfit,
                                             const GripMotions& grips,
                                             const Eigen::MatrixXd& grip_columns) {
  std::vector<NuisanceCandidate> nuisances = GripNuisances(grips, grip_columns);
  for (NuisanceCandidate& nuisance : ModelNuisances({problem, values, misfit, grips, grip_columns}))
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
  if (IsInEveryModel(hidden.type)) {
    // The model must lack the effect. At size zero, its absence is no error of the model.
    without.hidden.push_back(hidden);
    for (const std::string& name : hidden.amplitude) without.hidden[0].parameters[name] = 0;
  }
  SimulateCase(without, folder, /*rough=*/true);
  const PredictionStudy study = ReadPredictionStudy(Config::Load(folder / "experiment.yaml"));
  const ReferenceBody reference = MakeReferenceBody(study);
  const CalibrationProblem problem(study, reference.mesh);
  const Eigen::VectorXd values = TrueValues(trial, without, study, problem);
  std::vector<MisfitDirection> directions = SizeDirections(hidden);
  const GripMotions grips = MakeGripMotions(problem);
  directions.insert(directions.end(), grips.directions.begin(), grips.directions.end());
  LinearisedMisfit misfit = problem.Linearise(values, true, directions);
  if (!misfit.usable) throw InputError(trial.name + ": " + misfit.message);
  // The noise of a depth camera is that along its rays and stays as estimated.
  if (!trial.is_scanned)
    for (LinearisedMisfit::Part& part : misfit.parts)
      if (part.IsOfPoints()) part.errors.noise = trial.noise;
  const Eigen::Index known = values.size();
  Eigen::MatrixXd columns = misfit.jacobian.leftCols(known);
  std::vector<LinearPrior> priors = PriorsAbout(problem.parameters(), values);
  const auto add = [&](const Eigen::MatrixXd& more, const std::vector<LinearPrior>& its_priors) {
    columns.conservativeResize(Eigen::NoChange, columns.cols() + more.cols());
    columns.rightCols(more.cols()) = more;
    priors.insert(priors.end(), its_priors.begin(), its_priors.end());
  };
  const Eigen::Index of_grips = static_cast<Eigen::Index>(grips.directions.size());
  for (const NuisanceCandidate& nuisance :
       CaseNuisances(problem, values, misfit, grips, misfit.jacobian.rightCols(of_grips)))
    add(nuisance.columns, nuisance.priors);
  const int own = static_cast<int>(columns.cols());
  if (hidden.amplitude.empty()) {
    add(ChangeBy(hidden, problem, values, misfit), {{}});
  } else {
    Eigen::VectorXd amount(static_cast<Eigen::Index>(hidden.amplitude.size()));
    for (size_t k = 0; k < hidden.amplitude.size(); ++k)
      amount[static_cast<Eigen::Index>(k)] = hidden.parameters.at(hidden.amplitude[k]);
    add(misfit.jacobian.middleCols(known, amount.size()) * amount, {{}});
  }
  const LinearGaussianModel model(
      WhitenedRows(misfit.residual, misfit, trial.noise_correlation_time, false),
      WhitenedRows(columns, misfit, trial.noise_correlation_time, false), priors);
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
  if (trial.group != "removed") return;
  std::string types;
  for (const HiddenEffect& hidden : trial.hidden) types += hidden.type + "\n";
  WriteFileAtomically(folder / "without.txt", types);
}

// Determines the sizes of the hidden effects and simulates the case. Returns the reason of a
// failure, empty on success.
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
  } catch (const InputError& problem) {
    return problem.what();
  }
  return "";
}

}  // namespace

std::vector<std::string> ReadEffectTypes(const Config& config, const std::string& key) {
  std::vector<std::string> types = config.Texts(key);
  for (const std::string& type : types)
    if (FindEntry(type) == nullptr) config.Fail(key, "no effect is called \"" + type + "\"");
  return types;
}

TrialSuite ReadTrialSuite(const Config& config) {
  TrialSuite suite;
  config.Integer("schema_version", 1, 1);
  suite.name = config.Text("name");
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
  if (suite.factors.empty()) suite.factors = {1, 2, 4};
  if (suite.recordings.empty()) suite.recordings = {1, 2};
  config.RefuseUnknownKeys();
  return suite;
}

std::vector<TrialCase> CasesOf(const TrialSuite& suite) {
  std::vector<TrialCase> cases;
  const auto control = [&](const std::string& group, const std::string& nuisance, size_t k) {
    const size_t number = cases.size();
    const int recordings = suite.recordings[k % suite.recordings.size()];
    cases.push_back(DrawCase(fmt::format("{:04}-{}{}-{}rec", number, group,
                                         nuisance.empty() ? "" : "-" + nuisance, recordings),
                             group, RandomBits({suite.seed, number}), recordings, suite.is_scanned,
                             nuisance));
  };
  for (int k = 0; k < suite.controls; ++k) control("control", "", k);
  const std::vector<NuisanceTrial> disturbances = NuisanceControls();
  for (int k = 0; k < suite.hard_controls; ++k)
    control("hard_control",
            disturbances[(k / suite.recordings.size()) % disturbances.size()].control, k);
  const int largest = *std::max_element(suite.factors.begin(), suite.factors.end());
  for (const std::string& type : suite.removed)
    for (const int recordings : suite.recordings)
      cases.push_back(EffectCase(suite, "removed", {type}, largest, recordings, cases.size()));
  for (int k = 0; k < suite.pairs; ++k) {
    const uint64_t draw = RandomBits({suite.seed, 7, static_cast<uint64_t>(k)});
    const size_t count = suite.effects.size();
    const size_t first = draw % count, second = (first + 1 + (draw >> 20) % (count - 1)) % count;
    cases.push_back(EffectCase(suite, "pair", {suite.effects[first], suite.effects[second]},
                               largest, suite.recordings.back(), cases.size()));
  }
  for (const int factor : suite.factors)
    for (const std::string& type : suite.effects)
      for (const int recordings : suite.recordings)
        cases.push_back(EffectCase(suite, "one_effect", {type}, factor, recordings, cases.size()));
  for (TrialCase& trial : cases) {
    trial.load_cell = DrawLoadCell(trial.seed, suite.load_cells);
    if (trial.load_cell) trial.name += "-cell";
  }
  return cases;
}

bool MakeCase(TrialCase trial, const std::filesystem::path& folder) {
  const std::filesystem::path own = folder / trial.name;
  if (std::filesystem::exists(own / "skipped.txt")) return false;
  MakeFolder(own);
  if (std::filesystem::exists(own / "truth.json")) {
    // If only the truth was kept, the recordings are simulated again.
    if (!std::filesystem::exists(own / "experiment.yaml"))
      SimulateAndSeal(LoadCase(own / "truth.json"), own);
    return true;
  }
  std::string reasons;
  for (int attempt = 1;; ++attempt) {
    const std::string reason = SizeAndSimulate(&trial, own);
    if (reason.empty()) break;
    reasons += reason + "\n";
    if (trial.hidden.empty() || attempt == kMostAttempts) {
      WriteFileAtomically(own / "skipped.txt", reasons);
      return false;
    }
    trial = DrawnAgain(trial);
  }
  SaveCase(trial, own / "truth.json");
  return true;
}

int MakeTrials(const TrialSuite& suite, const std::filesystem::path& folder, int workers) {
  const std::vector<TrialCase> cases = CasesOf(suite);
  MakeFolder(folder);
  for (const TrialCase& trial : cases) MakeFolder(folder / trial.name);
  return ShareOut(cases.size(), {.workers = workers}, [&](size_t k) {
    const Claim claim(folder / cases[k].name / "claimed");
    if (claim.holds()) MakeCase(cases[k], folder);
  });
}

}  // namespace lacuna
