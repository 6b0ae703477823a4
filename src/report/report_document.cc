#include "report/report_document.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/json_file.h"
#include "core/json_number.h"
#include "record/csv_table.h"
#include "record/json_vector.h"
#include "record/ledger.h"
#include "record/library_versions.h"
#include "record/run_directory.h"
#include "record/run_record.h"
#include "report/headline.h"
#include "report/reported_run.h"
#include "report/run_differences.h"
#include "report/scene_document.h"
#include "report/verdict_text.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kSchema = 1;

// One run: its part of the document, and what a comparison with others needs.
struct GatheredRun {
  json document;
  std::vector<std::string> sentences;
  ComparableRun comparable;
};

// A path as seen from the folder that contains results/NAME, where commands are usually given, so
// that the document does not depend on where it is made.
std::string FromProject(const fs::path& path, const fs::path& run) {
  const auto normal = [](const fs::path& any) { return fs::absolute(any).lexically_normal(); };
  return normal(path / ".").parent_path().lexically_proximate(normal(run / "../..") / "").string();
}

json Provenance(const Manifest& manifest, const std::vector<std::string>& commands) {
  return {{"program", "Lacuna " + manifest.program_version},
          {"libraries", manifest.library_versions},
          {"configuration", manifest.configuration},
          {"inputs", manifest.inputs},
          {"seed", manifest.seed},
          {"commands", commands}};
}

json TableToJson(const CsvTable& table) {
  json columns = json::object();
  for (const CsvColumn& column : table) columns[column.name] = VectorToJson(column.values);
  return columns;
}

// --- Runs of `lacuna fit` ---

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

// "initial model", "with viscoelastic branch", "and with drag".
std::string LabelOf(const std::vector<ReportedModel>& models, size_t index) {
  if (index == 0) return "initial model";
  const std::string& added = models[index].added;
  const std::optional<DiagnosisRecord>& before = models[index - 1].diagnosis;
  return (index == 1 ? "with " : "and with ") + (before ? ShortTitle(*before, added) : added);
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
          {"label", LabelOf(models, index)},
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

// The rms length of the noise of a point, m. No single number stands for the patches of scans.
json NoiseOf(const CalibrationRecord& record) {
  const bool has_scans =
      std::any_of(record.recordings.begin(), record.recordings.end(),
                  [](const FittedRecording& recording) { return recording.scan.has_value(); });
  return has_scans ? json() : json(std::sqrt(3.0) * record.noise);
}

GatheredRun GatherFit(const fs::path& folder) {
  const ReportedRun run = OpenReportedRun(folder);
  const ReportedModel& opened = run.Opened();
  const Manifest manifest = LoadManifest(opened.folder / "manifest.json");
  json models = json::array();
  for (size_t k = 0; k < run.models.size(); ++k) models.push_back(ModelDocument(run.models, k));
  GatheredRun gathered;
  gathered.sentences = Headline(run.models);
  gathered.comparable = {opened.name, manifest, {}};
  for (const FittedRecording& recording : opened.calibration.recordings)
    gathered.comparable.spans.push_back({recording.name, recording.scan ? "scans" : "markers",
                                         recording.in_fit.frames, recording.held_out.frames});
  gathered.document = {{"name", opened.name},
                       {"folder", FromProject(folder, folder)},
                       {"kind", "prediction"},
                       {"models", models},
                       {"ledger", run.ledger},
                       {"noise", NoiseOf(opened.calibration)},
                       {"reconstruction", nullptr},
                       {"table1", nullptr},
                       {"trials", nullptr},
                       {"notes", run.notes},
                       {"provenance", Provenance(manifest, FitCommands(run, folder))}};
  return gathered;
}

// --- Runs of `lacuna reconstruct` ---

GatheredRun GatherReconstruction(const fs::path& folder) {
  const fs::path results = FinishedStage(folder, "results");
  const RunRecord record = LoadRunRecord(results);
  const Manifest manifest = LoadManifest(folder / "manifest.json");
  const std::string name = fs::path(FromProject(folder, folder)).filename().string();
  json scenes = json::array();
  if (json scene = ReconstructionScene(folder); !scene.is_null()) scenes.push_back(scene);
  GatheredRun gathered;
  gathered.sentences = ReconstructionHeadline(record);
  gathered.comparable = {
      name, manifest, {{record.recording, "scans", static_cast<int>(record.frames.size()), 0}}};
  gathered.document = {
      {"name", name},
      {"folder", FromProject(folder, folder)},
      {"kind", "reconstruction"},
      {"models",
       {{{"name", name}, {"added", ""}, {"label", "reconstruction"}, {"scenes", scenes}}}},
      {"ledger", nullptr},
      {"noise", nullptr},
      {"reconstruction",
       {{"record", ReadJsonFile(results / "record.json")},
        {"frames", TableToJson(LoadCsv(results / "frames.csv"))},
        {"trace", nullptr}}},
      {"table1", nullptr},
      {"trials", nullptr},
      {"notes", json::array()},
      {"provenance", Provenance(manifest, {"lacuna report " + FromProject(folder, folder)})}};
  return gathered;
}

// --- Studies of many runs: Table 1, its ablation, sealed cases, intervals ---

constexpr double kNotableRatio = 1.2;  // of a found modulus to the true one

// The largest drop of each row, as far as the table has it, beside the paper's, and how far a found
// modulus is from the true one.
std::vector<std::string> Table1Headline(const json& table) {
  std::vector<std::string> sentences;
  for (const json& row : table.at("rows")) {
    const json& drop = row.at("drop_from_max").at("median");
    if (drop.is_null()) continue;
    const std::string name = row.at("name");
    std::string sentence =
        fmt::format("The search \"{}\" lowers the residual per point by {:.1f} %", name,
                    100 * drop.get<double>());
    if (row.contains("paper_drop"))
      sentence +=
          fmt::format("; that of the paper by {:.1f} %", 100 * row.at("paper_drop").get<double>());
    sentences.push_back(sentence + ".");
    const double found = row.at("young_modulus_Pa").at("median");
    const double truth = table.at("truth").at("young_modulus_Pa");
    if (std::abs(std::log(found / truth)) < std::log(kNotableRatio)) continue;
    sentences.push_back(fmt::format(
        "It ends at a Young's modulus of {:.3g} MPa where {:.3g} MPa is true: forces that are "
        "fitted make up for a wrong modulus.",
        1e-6 * found, 1e-6 * truth));
  }
  return sentences;
}

// How often verdicts were right, one sentence for each kind of truth.
std::vector<std::string> TrialsHeadline(const json& trials) {
  std::vector<std::string> sentences;
  if (trials.is_null()) return sentences;
  std::string truth;
  for (const json& rate : trials.value("rates", json::array())) {
    if (rate.at("of") == 0 || rate.at("truth") == truth) continue;
    truth = rate.at("truth");
    sentences.push_back(fmt::format("In {} of {} cases in which {}, {}.",
                                    rate.at("cases").get<int>(), rate.at("of").get<int>(), truth,
                                    rate.at("what").get<std::string>()));
  }
  return sentences;
}

// table1.json with the trace of each search.
json Table1WithTraces(const fs::path& folder) {
  json table = ReadJsonFile(folder / "table1.json");
  table["traces"] = json::object();
  for (const json& row : table.at("rows")) {
    const std::string name = row.at("name");
    if (const fs::path file = folder / (name + ".csv"); fs::exists(file))
      table["traces"][name] = TableToJson(LoadCsv(file));
  }
  return table;
}

// The report of sealed cases; null where there is none.
json FindTrials(const fs::path& folder) {
  const fs::path file = folder / "report.json";
  if (!fs::exists(file)) return nullptr;
  json report = ReadJsonFile(file);
  return report.is_object() && report.contains("tallies") ? report : json();
}

// How often intervals contain the truth; null where there is no such file, or that of one draw.
// Throws InputError for a damaged one.
json FindIntervals(const fs::path& folder) {
  const fs::path file = folder / "intervals.json";
  if (!fs::exists(file)) return nullptr;
  json report = ReadJsonFile(file);
  const json parameters = report.is_object() ? report.value("parameters", json()) : json();
  const bool is_of_draws = parameters.is_array() && !parameters.empty() &&
                           parameters.front().is_object() && parameters.front().contains("draws");
  return is_of_draws ? report : json();
}

// One sentence for each parameter.
std::vector<std::string> IntervalsHeadline(const json& intervals) {
  std::vector<std::string> sentences;
  if (intervals.is_null()) return sentences;
  for (const json& one : intervals.at("parameters"))
    sentences.push_back(
        fmt::format("The 95 % interval of {} contains the truth in {:.0f} % of {} "
                    "draws.",
                    one.at("name").get<std::string>(), 100 * one.at("covered_95").get<double>(),
                    one.at("draws").get<int>()));
  return sentences;
}

bool IsStudy(const fs::path& folder) {
  return fs::exists(folder / "table1.json") || fs::exists(folder / "ablation.json") ||
         !FindTrials(folder).is_null() || !FindIntervals(folder).is_null();
}

GatheredRun GatherStudy(const fs::path& folder) {
  GatheredRun gathered;
  const std::string name = fs::path(FromProject(folder, folder)).filename().string();
  const bool has_table = fs::exists(folder / "table1.json");
  const bool has_ablation = fs::exists(folder / "ablation.json");
  json table;
  const auto add_sentences = [&](const char* what, const char* file, const auto& headline) {
    try {
      for (const std::string& sentence : headline()) gathered.sentences.push_back(sentence);
    } catch (const json::exception& problem) {
      throw InputError({(folder / file).string()},
                       fmt::format("is not {}: {}", what, problem.what()));
    }
  };
  if (has_table)
    add_sentences("a Table 1", "table1.json", [&] {
      table = Table1WithTraces(folder);
      return Table1Headline(table);
    });
  const json trials = FindTrials(folder), intervals = FindIntervals(folder);
  add_sentences("a report of sealed cases", "report.json", [&] { return TrialsHeadline(trials); });
  add_sentences("a table of intervals", "intervals.json",
                [&] { return IntervalsHeadline(intervals); });
  const std::string path = FromProject(folder, folder);
  json commands = json::array();
  if (has_table) {
    std::set<int> seeds;
    for (const json& search : table.at("searches")) seeds.insert(search.at("seed").get<int>());
    commands.push_back(fmt::format("lacuna table1 --output {} --seeds {}", path, seeds.size()));
  }
  commands.push_back("lacuna report " + path);
  gathered.comparable.name = name;
  gathered.document = {
      {"name", name},
      {"folder", path},
      {"kind", has_table || has_ablation ? "table1"
               : trials.is_null()        ? "intervals"
                                         : "trials"},
      {"models", json::array()},
      {"ledger", nullptr},
      {"noise", nullptr},
      {"reconstruction", nullptr},
      {"table1", table},
      {"ablation", has_ablation ? ReadJsonFile(folder / "ablation.json") : json()},
      {"trials", trials},
      {"intervals", intervals},
      {"notes", json::array()},
      {"provenance", {{"program", "Lacuna " + ProgramVersion()}, {"commands", commands}}}};
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
  const Manifest manifest = LoadManifest(folder / "manifest.json");
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
