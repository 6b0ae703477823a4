#include "trials/trial_run.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "calibration/adaptive_time_step.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_file.h"
#include "diagnosis/decision.h"
#include "diagnosis/decision_store.h"
#include "diagnosis/diagnosis.h"
#include "diagnosis/recorded_diagnosis.h"
#include "diagnosis/recording_power.h"
#include "prediction/predicted_body.h"
#include "prediction/prediction_study_reader.h"
#include "trials/case_files.h"

namespace lacuna {
namespace {

constexpr int kSchemaVersion = 5;  // of outcome.json
// The folder with the input of the decision with the hidden effect among the hypotheses, of a case
// in which the diagnosis does not know it.
constexpr char kWithRemovedFolder[] = "decision_with_removed";

const RankedEffect* Find(const Diagnosis& diagnosis, const std::string& type) {
  for (const RankedEffect& effect : diagnosis.ranking)
    if (effect.scored.candidate.type == type) return &effect;
  return nullptr;
}

// The estimated standard deviation of the noise over the true one. 1 for scans, whose noise along
// the normal depends on the view.
double EstimatedOverTrueNoise(const TrialCase& trial, const CalibrationProblem& problem) {
  return trial.is_scanned ? 1 : problem.noise() / trial.noise;
}

// Compares the fit of the first hidden effect with the truth.
void Compare(const TrialCase& trial, const CalibrationProblem& problem,
             const Eigen::VectorXd& values, const Diagnosis& diagnosis, TrialOutcome* outcome) {
  const HiddenEffect& hidden = trial.hidden.front();
  const RankedEffect* effect = Find(diagnosis, hidden.type);
  if (effect == nullptr || hidden.amplitude.empty()) return;  // there is no size to compare
  std::vector<ParameterEstimate> sizes = effect->sizes;
  double in_noise = effect->errors.without_nuisances;
  if (!effect->refitted) {
    Progress progress({.style = ProgressStyle::kSilent});
    const LinearisedMisfit misfit = problem.Linearise(values);
    const EffectRefit refit =
        Refit({{problem, values, misfit, &progress, nullptr, diagnosis.noise_level,
                diagnosis.decision_input.baseline.model_error},
               {}},
              &effect->scored, {.is_far_off = diagnosis.baseline_rms_over_sigma > kFarFromTruth});
    if (!refit.message.empty()) return;
    sizes = refit.sizes;
    in_noise = refit.errors.without_nuisances;
  } else if (!effect->refit_message.empty()) {
    return;
  }
  outcome->has_truth = true;
  outcome->error_after = in_noise * EstimatedOverTrueNoise(trial, problem);
  double difference = 0, size = 0;
  for (size_t k = 0; k < hidden.amplitude.size(); ++k) {
    const ParameterEstimate& estimate = sizes[k];
    const double truth = hidden.parameters.at(hidden.amplitude[k]);
    const double detectable = effect->scored.score.detectable[static_cast<Eigen::Index>(k)];
    difference += std::pow((estimate.value - truth) / detectable, 2);
    size += std::pow(truth / detectable, 2);
    outcome->covered.push_back(estimate.low <= truth && truth <= estimate.high);
  }
  outcome->relative_error = size > 0 ? std::sqrt(difference / size) : 1;
}

// How often recordings like that of the case, simulated to first order, lead to each verdict.
// `decided`: what the decision of the case was made from. No value unless exactly one effect is
// hidden and, where it is not in the library, a decision with it is in the folder `output`.
std::optional<RecordedPower> SimulatePowerOfCase(const TrialCase& trial,
                                                 const DecisionInput& decided,
                                                 const std::filesystem::path& output) {
  if (trial.hidden.size() != 1) return std::nullopt;
  const std::string& truth = trial.hidden.front().type;
  const bool is_known = trial.group != TrialGroup::kRemoved;
  // A residual that does not show the effect leaves no name.
  const RecordedPower invisible{.truth = {truth}, .open = 1, .most_wrong = ""};
  if (is_known) return PowerToFind(decided, truth, true).value_or(invisible);
  if (!std::filesystem::exists(output / kWithRemovedFolder / "decision.json")) return std::nullopt;
  return PowerToFind(ReadDecisionInput(output / kWithRemovedFolder), truth, false)
      .value_or(invisible);
}

// The same study with the time step that the diagnosis has chosen.
DecisionInput InputWithRemoved(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                               double time_step) {
  PredictionStudy study = problem.WithEstimatedNoise();
  study.time_step = time_step;
  Progress progress({.style = ProgressStyle::kSilent});
  return FirstOrderInput(CalibrationProblem(study, problem.body()->mesh), values, &progress);
}

}  // namespace

std::vector<std::string> RankedTypes(const std::vector<RankedEffect>& effects) {
  const auto rank = [](const RankedEffect& effect) {
    const bool is_refitted = effect.HasUsableRefit();
    return std::pair(is_refitted, is_refitted ? effect.evidence : effect.scored.score.evidence);
  };
  std::vector<const RankedEffect*> order;
  for (const RankedEffect& effect : effects) order.push_back(&effect);
  std::stable_sort(order.begin(), order.end(), [&](const RankedEffect* a, const RankedEffect* b) {
    return rank(*a) > rank(*b);
  });
  std::vector<std::string> types;
  for (const RankedEffect* effect : order) types.push_back(effect->scored.candidate.type);
  return types;
}

TrialOutcome RunCase(const std::filesystem::path& folder, const std::filesystem::path& output) {
  const auto began = std::chrono::steady_clock::now();
  PredictionStudy study = ReadPredictionStudy(Config::Load(output / kExperimentFile));
  const ReferenceBody reference = MakeReferenceBody(study);
  Progress progress({.style = ProgressStyle::kSilent});
  const Calibration calibration =
      FitWithAdaptiveTimeStep(reference.mesh, &study, &progress).calibration;
  const CalibrationProblem problem(study, reference.mesh);
  if (!calibration.HasSolution()) throw InputError(folder.string() + ": " + calibration.message);
  DiagnosisOptions options;
  // Before the diagnosis, only the list of effects removed from the library is used.
  std::ifstream without(folder / kWithoutFile);
  for (std::string type; std::getline(without, type);) options.without.push_back(type);
  const Diagnosis diagnosis = Diagnose(problem, calibration.parameters, options, &progress);
  WriteDecisionInput(diagnosis.decision_input, output / kDecisionFolder);
  WriteDiagnosisFile(RecordOf(diagnosis), output / kDiagnosisFile);

  TrialOutcome outcome;
  outcome.verdict = diagnosis.verdict;
  outcome.named = diagnosis.effects;
  outcome.probabilities = diagnosis.decision.probabilities;
  outcome.ranked = RankedTypes(diagnosis.ranking);
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();

  const TrialCase trial = ReadCase(folder);
  outcome.error_before =
      diagnosis.errors.without_nuisances * EstimatedOverTrueNoise(trial, problem);
  if (!trial.hidden.empty()) Compare(trial, problem, calibration.parameters, diagnosis, &outcome);
  if (trial.group == TrialGroup::kRemoved)
    WriteDecisionInput(InputWithRemoved(problem, calibration.parameters, diagnosis.time_step),
                       output / kWithRemovedFolder);
  outcome.simulated = SimulatePowerOfCase(trial, diagnosis.decision_input, output);
  return outcome;
}

void WriteTrialOutcome(const TrialOutcome& outcome, const std::filesystem::path& folder) {
  const nlohmann::json all = {
      {"schema_version", kSchemaVersion},
      {"verdict", VerdictName(outcome.verdict)},
      {"probabilities", ProbabilitiesToJson(outcome.probabilities)},
      {"simulated", outcome.simulated ? PowerToJson(*outcome.simulated) : nlohmann::json()},
      {"named", outcome.named},
      {"ranked", outcome.ranked},
      {"error_before", outcome.error_before},
      {"has_truth", outcome.has_truth},
      {"error_after", outcome.error_after},
      {"relative_error", outcome.relative_error},
      {"covered", outcome.covered},
      {"seconds", outcome.seconds}};
  WriteFileAtomically(folder / kOutcomeFile, all.dump(2) + "\n");
}

TrialOutcome ReadTrialOutcome(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kOutcomeFile;
  return ReadJsonFile(file, [&](const nlohmann::json& json) {
    const int version = json.at("schema_version");
    if (version > kSchemaVersion)
      throw InputError(fmt::format("{}: schema_version {} is of a later version of the program",
                                   file.string(), version));
    TrialOutcome outcome;
    outcome.verdict = VerdictFromName(json.at("verdict"));
    outcome.named = json.at("named");
    if (version >= 2) outcome.probabilities = ProbabilitiesFromJson(json.at("probabilities"));
    if (version >= 3 && !json.at("simulated").is_null())
      outcome.simulated = PowerFromJson(json.at("simulated"));
    outcome.ranked = json.at("ranked");
    outcome.error_before = json.at("error_before");
    outcome.has_truth = json.at("has_truth");
    outcome.error_after = json.at("error_after");
    outcome.relative_error = json.at("relative_error");
    for (const int covered : json.at("covered")) outcome.covered.push_back(covered != 0);
    outcome.seconds = json.at("seconds");
    return outcome;
  });
}

bool RedecideOutcome(const TrialCase& trial, const std::filesystem::path& output) {
  if (!std::filesystem::exists(output / kDecisionFolder / "decision.json") ||
      !std::filesystem::exists(output / kOutcomeFile))
    return false;
  const DecisionInput input = ReadDecisionInput(output / kDecisionFolder);
  const Decision decision = Decide(input);
  TrialOutcome outcome = ReadTrialOutcome(output);
  outcome.verdict = decision.verdict;
  outcome.named = decision.names;
  outcome.probabilities = decision.record.probabilities;
  outcome.simulated = SimulatePowerOfCase(trial, input, output);
  WriteTrialOutcome(outcome, output);
  return true;
}

bool RunTrials(const std::filesystem::path& folder, int workers) {
  const std::vector<std::filesystem::path> cases = CasesIn(folder);
  return WorkOn(cases, kOutcomeFile, workers,
                [&](size_t k) { WriteTrialOutcome(RunCase(cases[k], cases[k]), cases[k]); });
}

}  // namespace lacuna
