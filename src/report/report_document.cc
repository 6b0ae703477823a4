#include "report/report_document.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <string>
#include <utility>

#include "core/error.h"
#include "core/json_file.h"
#include "record/csv_table.h"
#include "record/library_versions.h"
#include "record/manifest.h"
#include "record/run_directory.h"
#include "record/run_record.h"
#include "report/fit_document.h"
#include "report/gathered_run.h"
#include "report/reconstruction_headline.h"
#include "report/reported_run.h"
#include "report/run_differences.h"
#include "report/scene_document.h"
#include "report/study_document.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kSchema = 1;

GatheredRun GatherReconstruction(const fs::path& folder) {
  const fs::path results = FinishedStage(folder, "results");
  const RunRecord record = ReadRunRecord(results);
  const Manifest manifest = ReadManifest(folder / "manifest.json");
  const std::string name = RunName(folder);
  json scenes = json::array();
  if (json scene = ReconstructionScene(folder); !scene.is_null()) scenes.push_back(scene);
  GatheredRun gathered;
  gathered.sentences = ReconstructionHeadline(record);
  gathered.comparable = {name, manifest, {{record.recording, "scans", record.FrameCount(), 0}}};
  json& document = gathered.document = EmptyRun(folder, "reconstruction");
  document["models"].push_back(
      {{"name", name}, {"added", ""}, {"label", "reconstruction"}, {"scenes", scenes}});
  document["reconstruction"] = {{"record", ReadJsonFile(results / "record.json")},
                                {"frames", TableToJson(ReadCsv(results / "frames.csv"))},
                                {"trace", nullptr}};
  document["provenance"] = Provenance(manifest, {"lacuna report " + FromProject(folder, folder)});
  return gathered;
}

GatheredRun Gather(const fs::path& folder) {
  if (!fs::exists(folder)) throw InputError({folder.string()}, "there is no such folder");
  if (IsStudy(folder)) return GatherStudy(folder);
  if (!fs::exists(folder / "manifest.json"))
    throw InputError(
        {folder.string()},
        "is not a run: it holds no manifest.json, table1.json, ablation.json, report.json or "
        "intervals.json");
  const Manifest manifest = ReadManifest(folder / "manifest.json");
  if (!manifest.finished)
    throw InputError({folder.string()},
                     "the run is not finished: run the same command again to resume it");
  if (manifest.stages.contains("calibration")) return GatherFit(folder);
  if (manifest.stages.contains("results")) return GatherReconstruction(folder);
  throw InputError({folder.string()}, "is a run of which no report can be made");
}

void RefuseOtherKinds(const std::vector<GatheredRun>& runs) {
  for (const GatheredRun& run : runs)
    if (run.document.at("kind") != runs.front().document.at("kind"))
      throw InputError(fmt::format(
          "{} is a {} and {} a {}: their errors cannot be compared", runs.front().comparable.name,
          runs.front().document.at("kind").get<std::string>(), run.comparable.name,
          run.document.at("kind").get<std::string>()));
}

}  // namespace

json ReportDocument(const std::vector<fs::path>& runs) {
  CHECK(!runs.empty());
  std::vector<GatheredRun> gathered;
  for (const fs::path& run : runs) gathered.push_back(Gather(run));
  RefuseOtherKinds(gathered);
  std::vector<ComparableRun> comparable;
  std::vector<std::string> names, sentences;
  json documents = json::array();
  for (GatheredRun& run : gathered) {
    comparable.push_back(run.comparable);
    names.push_back(run.document.at("name"));
    for (const std::string& sentence : run.sentences)
      sentences.push_back(gathered.size() > 1 ? names.back() + ": " + sentence : sentence);
    documents.push_back(std::move(run.document));
  }
  json differences = json::array();
  if (runs.size() > 1) {
    RefuseOtherMetrics(comparable);
    differences = ConfigurationDifferences(comparable);
  }
  return {{"schema", kSchema},
          {"program", "Lacuna " + ProgramVersion()},
          {"title", fmt::format("{}", fmt::join(names, ", "))},
          {"sentences", sentences},
          {"runs", documents},
          {"differences", differences}};
}

json WithoutPackedArrays(const json& document) {
  if (!document.is_structured()) return document;
  json kept = document.is_array() ? json::array() : json::object();
  for (const auto& [key, value] : document.items()) {
    if (value.is_object() && value.contains("base64")) continue;
    if (document.is_array()) {
      kept.push_back(WithoutPackedArrays(value));
    } else {
      kept[key] = WithoutPackedArrays(value);
    }
  }
  return kept;
}

}  // namespace lacuna
