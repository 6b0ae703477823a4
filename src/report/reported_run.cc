#include "report/reported_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/hash.h"
#include "core/json_file.h"
#include "record/ledger.h"
#include "record/plan_record.h"
#include "record/run_directory.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

fs::path CalibrationFile(const fs::path& folder) {
  return FinishedStage(folder, "calibration") / "calibration.json";
}

bool IsOfAnotherVersion(const fs::path& folder) {
  return IsCalibrationOfAnotherFormat(CalibrationFile(folder));
}

ReportedModel OpenModel(const fs::path& folder, const std::string& added,
                        std::vector<std::string>* notes) {
  ReportedModel model;
  model.folder = folder;
  model.name = RunName(folder);
  model.added = added;
  const fs::path fit = CalibrationFile(folder);
  model.fit = HashFile(fit);
  model.calibration = ReadCalibrationFile(fit);
  if (model.calibration.usable) model.errors = ErrorsOf(model.calibration);
  for (const std::string& note : model.calibration.notes)
    notes->push_back(fmt::format("The fit of {}: {}.", model.name, note));
  const auto leave_out = [&](const char* what, const std::string& origin, const char* command) {
    notes->push_back(fmt::format(
        "The {} in the folder of {} is of {} and is not shown; `lacuna {}` makes a new one.", what,
        model.name, origin, command));
  };
  if (const fs::path file = folder / "comparison/comparison.json"; fs::exists(file)) {
    if (IsComparisonOf(model.fit, file))
      model.comparison = ReadComparisonFile(file);
    else
      leave_out("comparison", "an earlier fit", "compare");
  }
  if (const fs::path file = folder / "diagnosis/diagnosis.json"; fs::exists(file)) {
    if (IsDiagnosisOf(model.fit, folder / "diagnosis")) {
      model.diagnosis = ReadDiagnosisFile(file);
    } else {
      leave_out("diagnosis", "an earlier fit", "diagnose");
    }
  }
  if (const fs::path file = folder / "plan/plan.json"; fs::exists(file)) {
    if (!model.diagnosis || !IsPlanOf(HashFile(folder / "diagnosis/diagnosis.json"), file))
      leave_out("plan", "an earlier diagnosis", "plan");
    else if (const RecordVersion version = VersionOfPlan(file); version != RecordVersion::kThis)
      leave_out("plan", RecordVersionText(version), "plan");
    else
      model.has_plan = true;
  }
  return model;
}

// Whether the ledger's errors of a model are those of the fit that stands in its folder.
bool IsOf(const json& entry, const ReportedModel& model) {
  constexpr double kRounding = 1e-9;
  const double then = entry.at("errors").at("held_out_rms_m");
  return entry.at("usable") == model.calibration.usable &&
         std::abs(then - model.errors.held_out_rms) <= kRounding * then;
}

// Opens the models that the ledger lists. False where they have changed since.
bool OpenLedger(const fs::path& folder, ReportedRun* run) {
  const fs::path file = folder / "ledger.json";
  if (!fs::exists(file)) return false;
  const json ledger = ReadJsonFile(file);
  std::vector<std::string> notes;
  std::vector<ReportedModel> models;
  try {
    for (const json& entry : ledger.at("models")) {
      const fs::path of_model = (folder / entry.at("run").get<std::string>()).lexically_normal();
      if (!IsFittedRun(of_model) || IsOfAnotherVersion(of_model)) break;
      models.push_back(OpenModel(of_model, entry.value("added", ""), &notes));
      if (!IsOf(entry, models.back())) break;
    }
    const json& all = ledger.at("models");
    if (models.size() != all.size() || models.empty() || !IsOf(all.back(), models.back())) {
      run->notes.push_back(
          "The ledger of models does not belong to the fits in the folders, or one of these is of "
          "another version of Lacuna; it is not shown; "
          "`lacuna diagnose --until-done` makes a new one.");
      return false;
    }
  } catch (const json::exception& problem) {
    throw InputError({file.string()}, std::string("is not a ledger: ") + problem.what());
  }
  run->ledger = ledger;
  run->models = std::move(models);
  run->notes.insert(run->notes.end(), notes.begin(), notes.end());
  return true;
}

// How often a configuration has an effect of the catalogue or a law of this name, the material
// included.
int CountOf(const std::string& effect, const json& configuration) {
  int count = configuration.value("material", json::object()).value("law", "") == effect;
  for (const json& one : configuration.value("effects", json::array()))
    count += one.value("type", "") == effect || one.value("name", "") == effect;
  return count;
}

// What is predicted and fitted of each recording. Where the recordings lie does not matter.
json FramesOf(const Manifest& manifest) {
  json recordings = manifest.configuration.value("recordings", json::array());
  for (json& recording : recordings) recording.erase("recording");
  return recordings;
}

// Whether the run `after` has the model of the run `before` with this effect added, and the same
// recordings.
bool IsAddedTo(const fs::path& before, const std::string& effect, const fs::path& after) {
  const Manifest old = ReadManifest(before / "manifest.json");
  const Manifest added = ReadManifest(after / "manifest.json");
  try {
    return CountOf(effect, added.configuration) > CountOf(effect, old.configuration) &&
           added.inputs == old.inputs && FramesOf(added) == FramesOf(old);
  } catch (const json::exception&) {
    return false;  // a configuration of another kind of run
  }
}

}  // namespace

std::string RunName(const fs::path& folder) {
  return fs::absolute(folder / ".").lexically_normal().parent_path().filename().string();
}

bool IsFittedRun(const fs::path& folder) {
  if (!fs::exists(folder / "manifest.json")) return false;
  const Manifest manifest = ReadManifest(folder / "manifest.json");
  return manifest.finished && manifest.stages.contains("calibration");
}

ReportedRun OpenReportedRun(const fs::path& folder) {
  ReportedRun run;
  if (OpenLedger(folder, &run)) return run;
  // A run NAME+EFFECT was made from the run NAME beside it.
  run.models.push_back(OpenModel(folder, "", &run.notes));
  const fs::path beside = fs::absolute(folder / "..").lexically_normal();
  for (size_t plus = run.models.front().name.rfind('+'); plus != std::string::npos;
       plus = run.models.front().name.rfind('+')) {
    const std::string before = run.models.front().name.substr(0, plus);
    const std::string effect = run.models.front().name.substr(plus + 1);
    if (before.empty() || !IsFittedRun(beside / before) ||
        !IsAddedTo(beside / before, effect, run.models.front().folder))
      break;
    if (IsOfAnotherVersion(beside / before)) {
      run.notes.push_back(fmt::format(
          "The run {} is of another version of Lacuna and is not shown; fit it again.", before));
      break;
    }
    run.models.front().added = effect;
    run.models.insert(run.models.begin(), OpenModel(beside / before, "", &run.notes));
  }
  return run;
}

}  // namespace lacuna
