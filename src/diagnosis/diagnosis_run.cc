#include "diagnosis/diagnosis_run.h"

#include <fmt/format.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "diagnosis/decision_store.h"
#include "diagnosis/model_change.h"
#include "diagnosis/recorded_diagnosis.h"
#include "effects/catalogue.h"
#include "record/run_directory.h"

namespace lacuna {
namespace {

using nlohmann::json;

// Raised when the diagnosis changes so that its result does.
constexpr int kDiagnosisVersion = 61;

std::filesystem::path ResultFile(const std::filesystem::path& run) {
  return run / "diagnosis" / "diagnosis.json";
}
std::filesystem::path OriginFile(const std::filesystem::path& run) {
  return run / "diagnosis" / "of_fit.json";
}

std::filesystem::path DecisionFolder(const std::filesystem::path& run) {
  return run / "diagnosis" / "decision";
}

// Refits of a diagnosis that is not complete.
std::filesystem::path RefitsFile(const std::filesystem::path& run) {
  return run / "diagnosis" / "refits.json";
}

// One hash for what belongs to diagnosis.json: how its effects were set up, and the files that its
// decision was made from.
std::string DetailsHash(const std::filesystem::path& run, const json& settings) {
  std::map<std::string, std::string> hashes;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(DecisionFolder(run), error))
    if (!IsTemporaryFile(entry.path()))
      hashes[entry.path().filename().string()] = HashFile(entry.path());
  return HashBytes(settings.dump() + json(hashes).dump());
}

json OriginOf(const std::filesystem::path& run, const DiagnosisOptions& options) {
  return {{"version", kDiagnosisVersion},
          {"fit", HashFile(FinishedStage(run, "calibration") / "calibration.json")},
          {"fit_key", ReadManifest(run / "manifest.json").stages.at("calibration").key},
          {"refits", options.refits},
          {"without", options.without}};
}

json SettingsOf(const Diagnosis& diagnosis) {
  json settings = json::object();
  for (const RankedEffect& effect : diagnosis.ranking) {
    const CandidateEffect& candidate = effect.scored.candidate;
    const Eigen::VectorXd start = StartOfRefit(effect.scored);
    const Eigen::VectorXd& values = effect.values.size() > 0 ? effect.values : start;
    json known = json::object();
    for (const auto& [name, range] : candidate.known) known[name] = {range.min, range.max};
    settings[candidate.type] = {{"values", std::vector<double>(values.begin(), values.end())},
                                {"start", std::vector<double>(start.begin(), start.end())},
                                {"model", std::vector<double>(effect.baseline_values.begin(),
                                                              effect.baseline_values.end())},
                                {"amplitude", candidate.amplitude},
                                {"refined", candidate.refined},
                                {"known", known},
                                {"replaces_material", candidate.replaces_material},
                                {"body",
                                 {{"young_modulus", candidate.body.young_modulus},
                                  {"density", candidate.body.density},
                                  {"length", candidate.body.length}}}};
  }
  return settings;
}

// An effect of the catalogue, or one of the user's laws; null: there is none with such values.
std::shared_ptr<const Effect> MadeFrom(const PredictionStudy& study, const std::string& type,
                                       const Eigen::VectorXd& values) {
  const auto fits = [&](const EffectCard& card) {
    return static_cast<Eigen::Index>(card.parameters.size()) == values.size();
  };
  for (const OwnLaw& law : study.candidates)
    if (law.name == type && fits(law.effect->Card())) return law.effect->WithParameters(values);
  const CatalogueEntry* entry = FindEntry(type);
  return entry != nullptr && entry->make != nullptr && fits(*entry->card) ? entry->make(values)
                                                                          : nullptr;
}

// Null where the file is not there or is none.
json Parsed(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return json::parse(stream, nullptr, /*allow_exceptions=*/false);
}

// OriginOf() as it was for the diagnosis that stands there; null: there is none, or it was changed.
json OriginOfWhatStands(const std::filesystem::path& run) {
  const json origin = Parsed(OriginFile(run));
  if (!origin.is_object() || !std::filesystem::exists(ResultFile(run)) ||
      origin.value("diagnosis", "") != HashFile(ResultFile(run)))
    return {};
  // Diagnoses of earlier versions have no such hash.
  if (origin.contains("details") &&
      origin.at("details") != DetailsHash(run, origin.value("settings", json())))
    return {};
  return origin.value("of", json());
}

// Removes refits that the diagnosis of this origin has left because it was killed at its very end.
// The refits of another diagnosis, which is not complete, stay.
void RemoveRefitsOf(const json& origin, const std::filesystem::path& run) {
  const json refits = Parsed(RefitsFile(run));
  std::error_code ignored;  // a file that remains is harmless
  if (refits.is_object() && refits.value("of", json()) == origin)
    std::filesystem::remove(RefitsFile(run), ignored);
}

// Whether the diagnosis that stands there is of the fit that stands there, with whatever options.
bool IsOfThisFit(const std::filesystem::path& run) {
  const json stands = OriginOfWhatStands(run), expected = OriginOf(run, {});
  for (const char* what : {"version", "fit", "fit_key"})
    if (!stands.contains(what) || stands.at(what) != expected.at(what)) return false;
  return true;
}

}  // namespace

bool IsDiagnosed(const std::filesystem::path& run, const DiagnosisOptions& options) {
  return OriginOfWhatStands(run) == OriginOf(run, options);
}

DiagnosisRecord RunDiagnosis(const FittedRun& fitted, const std::filesystem::path& run,
                             const DiagnosisOptions& options, Progress* progress) {
  RemoveLeftTemporaries(run);
  if (IsDiagnosed(run, options)) {
    RemoveRefitsOf(OriginOf(run, options), run);
    progress->Begin("diagnosis of " + fitted.study.name, 0);
    DiagnosisRecord record = ReadDiagnosisFile(ResultFile(run));
    progress->End("read back");
    return record;
  }
  const CalibrationProblem problem(fitted.study, fitted.mesh);
  MakeFolder(ResultFile(run).parent_path());
  FitStore kept(RefitsFile(run), OriginOf(run, options));
  const Diagnosis diagnosis = Diagnose(problem, fitted.values, options, progress, &kept,
                                       ReadOtherMesh(FinishedStage(run, "calibration")));
  WriteDecisionInput(diagnosis.decision_input, DecisionFolder(run));
  WriteDiagnosisFile(RecordOf(diagnosis), ResultFile(run));
  const json settings = SettingsOf(diagnosis);
  const json origin = {{"schema_version", 2},
                       {"of", OriginOf(run, options)},
                       {"diagnosis", HashFile(ResultFile(run))},
                       {"details", DetailsHash(run, settings)},
                       {"settings", settings}};
  WriteFileAtomically(OriginFile(run), origin.dump(2) + "\n");
  kept.Drop();
  return ReadDiagnosisFile(ResultFile(run));
}

ScoredEffect DiagnosedEffect(const FittedRun& fitted, const std::filesystem::path& run,
                             const RecordedEffect& effect) {
  const json origin = Parsed(OriginFile(run));
  try {
    const json& settings = origin.at("settings").at(effect.type);
    const std::vector<double> values = settings.at("values");
    ScoredEffect scored;
    CandidateEffect& candidate = scored.candidate;
    candidate.type = effect.type;
    candidate.variant = effect.variant;
    candidate.amplitude = settings.at("amplitude").get<std::vector<int>>();
    candidate.refined = settings.at("refined").get<std::map<std::string, double>>();
    for (const auto& [name, range] : settings.at("known").items())
      candidate.known[name] = {range.at(0), range.at(1)};
    candidate.replaces_material = settings.at("replaces_material");
    const json& body = settings.at("body");
    candidate.body = {body.at("young_modulus"), body.at("density"), body.at("length")};
    const std::vector<double> model = settings.at("model");
    scored.baseline_values =
        Eigen::Map<const Eigen::VectorXd>(model.data(), static_cast<Eigen::Index>(model.size()));
    const std::string other =
        OriginFile(run).string() + ": was made with another catalogue of effects; diagnose again";
    candidate.effect = MadeFrom(
        fitted.study, effect.type,
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
    if (candidate.effect == nullptr) throw InputError(other);
    if (AmountsOf(candidate).size() != effect.sizes.size()) throw InputError(other);
    const std::vector<double> start = settings.at("start");
    if (start.size() != values.size()) throw InputError(other);
    candidate.prior_centre =
        Eigen::Map<const Eigen::VectorXd>(start.data(), static_cast<Eigen::Index>(start.size()));
    Score& score = scored.score;
    score.evidence = effect.HasUsableRefit() ? effect.refit->evidence : effect.first_order.evidence;
    score.size.setOnes(static_cast<Eigen::Index>(effect.sizes.size()));  // of a pilot
    score.detectable = score.size;
    for (size_t k = 0; k < effect.sizes.size(); ++k) {
      const Eigen::Index at = static_cast<Eigen::Index>(k);
      if (!candidate.IsPilot()) {
        const int index = candidate.amplitude[k];
        score.size[at] = values[static_cast<size_t>(index)] -
                         candidate.effect->Card().parameters[index].null_value;
      }
      score.detectable[at] = effect.sizes[k].detectable;
    }
    return scored;
  } catch (const json::exception& problem) {
    throw InputError(fmt::format("{}: does not tell how {} is set up: {}", OriginFile(run).string(),
                                 effect.type, problem.what()));
  }
}

std::optional<KeptDiagnosis> FindDiagnosis(const std::filesystem::path& run) {
  if (!IsOfThisFit(run)) return std::nullopt;
  return KeptDiagnosis{ReadDiagnosisFile(ResultFile(run)), ReadDecisionInput(DecisionFolder(run))};
}

std::optional<ScoredEffect> FindDiagnosed(const FittedRun& fitted, const std::filesystem::path& run,
                                          const std::string& type) {
  if (!IsOfThisFit(run)) return std::nullopt;
  for (const RecordedEffect& effect : ReadDiagnosisFile(ResultFile(run)).ranking)
    if (effect.type == type) return DiagnosedEffect(fitted, run, effect);
  return std::nullopt;
}

}  // namespace lacuna
