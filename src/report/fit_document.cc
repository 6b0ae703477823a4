#include "report/fit_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "core/json_file.h"
#include "record/calibration_record.h"
#include "record/ledger.h"
#include "record/manifest.h"
#include "report/headline.h"
#include "report/reported_run.h"
#include "report/scene_document.h"
#include "report/verdict_text.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::vector<std::string> FitCommands(const ReportedRun& run, const fs::path& folder) {
  const ReportedModel& first = run.models.front();
  const std::string name = FromProject(first.folder, folder);
  std::vector<std::string> commands{
      "lacuna fit " + FromProject(first.folder / first.calibration.experiment, folder)};
  if (first.comparison) commands.push_back("lacuna compare " + name);
  if (!run.ledger.is_null()) {
    commands.push_back("lacuna diagnose " + name + " --until-done");
  } else {
    if (first.diagnosis) commands.push_back("lacuna diagnose " + name);
    for (size_t k = 1; k < run.models.size(); ++k)
      commands.push_back(fmt::format(
          "lacuna add {} {}", FromProject(run.models[k - 1].folder, folder), run.models[k].added));
  }
  commands.push_back("lacuna report " + FromProject(folder, folder));
  return commands;
}

// Whether the model could be fitted and the size of each effect that was added to the first one is
// known not to be zero.
bool Counts(const std::vector<ReportedModel>& models, size_t index) {
  for (size_t k = 1; k <= index; ++k)
    if (models[k - 1].diagnosis &&
        SizeMayBeZero(models[k].calibration, *models[k - 1].diagnosis, models[k].added))
      return false;
  return models[index].calibration.usable;
}

// A comparison without the correlations of all pairs of points: hundreds of points have millions of
// bytes of them, and a page shows none.
json WithoutPairs(json comparison) {
  if (comparison.is_null()) return comparison;
  for (json& recording : comparison.at("recordings"))
    for (json& part : recording.at("parts")) part.at("space_correlation").erase("pairs");
  return comparison;
}

// Whether points have noise of their own, so that no single number holds for all errors.
bool ShowsOwnNoise(const json& model) {
  const json& scenes = model.at("scenes");
  return std::any_of(scenes.begin(), scenes.end(),
                     [](const json& scene) { return scene.at("points").contains("sigmas"); });
}

json ModelDocument(const std::vector<ReportedModel>& models, size_t index) {
  const ReportedModel& model = models[index];
  const auto file = [&](bool exists, const char* name) {
    return exists ? ReadJsonFile(model.folder / name) : json();
  };
  const ModelErrors& errors = model.errors;
  const bool usable = model.calibration.usable;
  const auto if_usable = [&](double value) { return usable ? json(value) : json(); };
  return {{"name", model.name},
          {"added", model.added},
          {"label",
           ModelLabel(index, model.added, index > 0 ? models[index - 1].diagnosis : std::nullopt)},
          {"counts", Counts(models, index)},
          {"errors",
           {{"in_fit", if_usable(errors.in_fit_rms)},
            {"held_out", if_usable(errors.held_out_rms)},
            {"held_out_over_sigma", if_usable(errors.rms_over_sigma)},
            {"has_held_out", errors.has_held_out}}},
          {"calibration", file(true, "calibration/calibration.json")},
          {"comparison",
           WithoutPairs(file(model.comparison.has_value(), "comparison/comparison.json"))},
          {"diagnosis", file(model.diagnosis.has_value(), "diagnosis/diagnosis.json")},
          {"plan", file(model.has_plan, "plan/plan.json")},
          {"scenes", SceneDocuments(model)}};
}

}  // namespace

GatheredRun GatherFit(const fs::path& folder) {
  const ReportedRun run = OpenReportedRun(folder);
  const ReportedModel& opened = run.Opened();
  const Manifest manifest = ReadManifest(opened.folder / "manifest.json");
  json models = json::array();
  for (size_t k = 0; k < run.models.size(); ++k) models.push_back(ModelDocument(run.models, k));
  const std::optional<double> noise = RmsOfNoise(opened.calibration);
  GatheredRun gathered;
  gathered.sentences = Headline(run.models);
  gathered.comparable = {opened.name, manifest, {}};
  for (const FittedRecording& recording : opened.calibration.recordings)
    gathered.comparable.spans.push_back({recording.name, recording.scan ? "scans" : "markers",
                                         recording.in_fit.frames, recording.held_out.frames});
  json& document = gathered.document = EmptyRun(folder, "prediction");
  document["name"] = opened.name;
  document["models"] = models;
  document["ledger"] = run.ledger;
  if (noise && std::none_of(models.begin(), models.end(), ShowsOwnNoise))
    document["noise"] = *noise;
  document["notes"] = run.notes;
  document["provenance"] = Provenance(manifest, FitCommands(run, folder));
  return gathered;
}

}  // namespace lacuna
