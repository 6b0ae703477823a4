#include "study/diagnosis_run.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "effects/catalogue.h"
#include "record/run_directory.h"

namespace lacuna {
namespace {

using nlohmann::json;

// Raised when the diagnosis changes so that its result does.
constexpr int kDiagnosisVersion = 13;

std::filesystem::path ResultFile(const std::filesystem::path& run) {
  return run / "diagnosis" / "diagnosis.json";
}
std::filesystem::path OriginFile(const std::filesystem::path& run) {
  return run / "diagnosis" / "of_fit.json";
}

json OriginOf(const std::filesystem::path& run, const DiagnosisOptions& options) {
  return {{"version", kDiagnosisVersion},
          {"fit", HashFile(FinishedStage(run, "calibration") / "calibration.json")},
          {"fit_key", LoadManifest(run / "manifest.json").stages.at("calibration").key},
          {"refits", options.refits},
          {"without", options.without}};
}

json SettingsOf(const Diagnosis& diagnosis) {
  json settings = json::object();
  for (const RankedEffect& effect : diagnosis.ranking) {
    const CandidateEffect& candidate = effect.scored.candidate;
    const Eigen::VectorXd values = candidate.effect->Parameters();
    settings[candidate.type] = {{"values", std::vector<double>(values.begin(), values.end())},
                                {"amplitude", candidate.amplitude},
                                {"replaces_material", candidate.replaces_material}};
  }
  return settings;
}

// Null where the file is not there or is none.
json Parsed(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return json::parse(stream, nullptr, /*allow_exceptions=*/false);
}

}  // namespace

bool IsDiagnosed(const std::filesystem::path& run, const DiagnosisOptions& options) {
  const json origin = Parsed(OriginFile(run));
  return origin.is_object() && origin.value("of", json()) == OriginOf(run, options) &&
         std::filesystem::exists(ResultFile(run)) &&
         origin.value("diagnosis", "") == HashFile(ResultFile(run));
}

DiagnosisRecord RunDiagnosis(const FittedRun& fitted, const std::filesystem::path& run,
                             const DiagnosisOptions& options, Progress* progress) {
  for (size_t k = 0; k < fitted.study.fitted.size(); ++k)
    SetParameter(fitted.study.fitted[k], fitted.values[static_cast<Eigen::Index>(k)]);
  if (IsDiagnosed(run, options)) {
    progress->Begin("diagnosis of " + fitted.study.name, 0);
    DiagnosisRecord record = ReadDiagnosisFile(ResultFile(run));
    progress->End("read back");
    return record;
  }
  const CalibrationProblem problem(fitted.study, fitted.mesh);
  const Diagnosis diagnosis = Diagnose(problem, fitted.values, options, progress);
  MakeFolder(ResultFile(run).parent_path());
  SaveDiagnosis(diagnosis, ResultFile(run));
  const json origin = {{"schema_version", 1},
                       {"of", OriginOf(run, options)},
                       {"diagnosis", HashFile(ResultFile(run))},
                       {"settings", SettingsOf(diagnosis)}};
  WriteFileAtomically(OriginFile(run), origin.dump(2) + "\n");
  problem.SetModel(fitted.values);
  return ReadDiagnosisFile(ResultFile(run));
}

ScoredEffect DiagnosedEffect(const std::filesystem::path& run, const RecordedEffect& effect) {
  const json origin = Parsed(OriginFile(run));
  const CatalogueEntry* entry = FindEntry(effect.type);
  try {
    const json& settings = origin.at("settings").at(effect.type);
    const std::vector<double> values = settings.at("values");
    ScoredEffect scored;
    CandidateEffect& candidate = scored.candidate;
    candidate.type = effect.type;
    candidate.variant = effect.variant;
    candidate.amplitude = settings.at("amplitude").get<std::vector<int>>();
    candidate.replaces_material = settings.at("replaces_material");
    const std::string other =
        OriginFile(run).string() + ": is of another catalogue; diagnose again";
    if (entry == nullptr || values.size() != entry->card->parameters.size())
      throw InputError(other);
    candidate.effect = entry->make(
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
    if (AmountsOf(candidate).size() != effect.sizes.size()) throw InputError(other);
    scored.score.size.resize(static_cast<Eigen::Index>(effect.sizes.size()));
    for (size_t k = 0; k < effect.sizes.size(); ++k)
      scored.score.size[static_cast<Eigen::Index>(k)] = effect.sizes[k].expected;
    return scored;
  } catch (const json::exception& problem) {
    throw InputError(fmt::format("{}: does not tell how {} is set up: {}", OriginFile(run).string(),
                                 effect.type, problem.what()));
  }
}

}  // namespace lacuna
