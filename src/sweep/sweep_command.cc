#include "sweep/sweep_command.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <map>

#include "calibration/calibration_run.h"
#include "core/error.h"
#include "paper/table1_report.h"
#include "prediction/prediction_study_reader.h"
#include "reconstruction/reconstruction.h"
#include "reconstruction/reconstruction_study.h"

namespace lacuna {
namespace {

int SearchSeed(const Config& experiment) { return experiment.Integer("seed", 1, 1 << 30, 1); }

CaseOutcome RunCaseSearch(const Config& experiment, const std::filesystem::path& folder,
                          Progress* progress) {
  const Table1Study study = ReadTable1(std::vector<Config>{experiment});
  Table1Options options;
  options.output = folder / "run";
  options.first_seed = SearchSeed(experiment);
  options.turns = 0;
  options.profile = options.in_loop = false;
  const Table1Result result = RunTable1(study, options, progress);
  const Table1Search& search = result.seeds.front().searches.front();
  const ParameterSearchResult& found = search.found;
  CaseOutcome outcome;
  outcome.done = found.IsUsable();
  outcome.words = {{"ended", ToString(found.status)}, {"trace_hash", found.trace_hash}};
  if (!outcome.done) {
    outcome.message = "no evaluation succeeded";
    if (!found.evaluations.empty()) outcome.message += ": " + found.evaluations[0].failure;
    return outcome;
  }
  const ObjectiveMeasure measure = study.configurations.front().search.measure;
  const ObjectiveEvaluation& start = found.evaluations.front();
  const ObjectiveEvaluation& best = found.evaluations[static_cast<size_t>(found.best)];
  const SearchedParameters& at = found.parameters[static_cast<size_t>(found.best)];
  const auto failures = static_cast<double>(found.failures);
  outcome.numbers = {
      {"start_value_m", ValueOf(start, measure)},
      {"best_value_m", ValueOf(best, measure)},
      {"evaluations", static_cast<double>(found.evaluations.size())},
      {"radius_edge_ratio", at.radius_edge_ratio},
      {"max_volume_m3", at.max_volume},
      {"young_modulus_Pa", at.young_modulus},
      {"poisson_ratio", at.poisson_ratio},
      {"failed_evaluations", failures},
      {"best_evaluation", found.best + 1.0},
      {"largest_value_m", ValueOf(found.evaluations[static_cast<size_t>(search.worst)], measure)},
      {"value_at_truth_m", ValueOf(search.at_truth, measure)},
      {"start_residual_sum_m", start.residual_sum},
      {"best_residual_sum_m", best.residual_sum},
      {"best_scan_distance_m", best.scan_distance},
      {"best_nodes", static_cast<double>(best.nodes)},
      {"evaluation_seconds", found.Seconds()}};
  return outcome;
}

// The files of a table1 case in the order in which that command uses them.
std::vector<Config> ByRow(std::vector<Config> files) {
  std::vector<std::pair<int, size_t>> order;
  for (size_t k = 0; k < files.size(); ++k) order.emplace_back(files[k].Integer("row", 1, 1000), k);
  std::sort(order.begin(), order.end());
  std::vector<Config> sorted;
  for (const auto& [row, k] : order) sorted.push_back(files[k]);
  return sorted;
}

CaseOutcome Table1(const SweepSettings& settings, const std::filesystem::path& folder,
                   Progress* progress) {
  const Table1Study study = ReadTable1(folder / "experiments");
  Table1Options options;
  options.output = folder / "run";
  options.seeds = settings.seeds;
  options.turns = settings.turns;
  const Table1Result result = RunTable1(study, options, progress);
  WriteTable1(study, result, options.output);
  CaseOutcome outcome;
  outcome.done = true;
  const Table1Summary summary = Summarise(study, result);
  for (const Table1Row& row : summary.rows) {
    if (row.seeds < settings.seeds) {
      outcome.done = false;
      outcome.message = row.name + ": no evaluation succeeded";
    }
    const std::vector<std::pair<const char*, double>> medians = {
        {"best_per_point_m", row.best.median},
        {"drop_from_start", row.drop_from_start.median},
        {"drop_from_max", row.drop_from_max.median},
        {"sum_drop_from_max", row.sum_drop.median},
        {"young_modulus_Pa", row.young_modulus.median},
        {"poisson_ratio", row.poisson_ratio.median},
        {"below_truth", row.below_truth.median}};
    for (const auto& [name, value] : medians)
      outcome.numbers.emplace_back(row.name + "." + name, value);
  }
  outcome.numbers.emplace_back("last_is_best", summary.last_is_best);
  outcome.numbers.emplace_back("seeds", settings.seeds);
  return outcome;
}

}  // namespace

CaseOutcome OutcomeOf(const RunRecord& record) {
  CaseOutcome outcome;
  outcome.done = record.IsUsable();
  int unusable = record.frames_not_tried;
  for (const FrameRecord& frame : record.frames) {
    if (frame.solver.usable) continue;
    ++unusable;
    if (outcome.message.empty())
      outcome.message = fmt::format("frame {}: {}", frame.frame, frame.solver.message);
  }
  for (const auto& [stage, status] : record.stages)
    if (!status.usable && outcome.message.empty())
      outcome.message = fmt::format("{}: {}", stage, status.message);
  std::map<std::string, double> measures = record.measures;
  const auto take = [&measures](const char* name) -> std::pair<std::string, double> {
    const auto measure = measures.extract(name);
    return {name, measure ? measure.mapped() : kNotMeasured};
  };
  outcome.numbers = {{"animation_residual_m", record.animation_residual},
                     take("residual_per_point_m"),
                     take("surface_distance_mean_m"),
                     {"nodes", static_cast<double>(record.mesh.node_count)},
                     {"tetrahedra", static_cast<double>(record.mesh.tet_count)},
                     {"frames", static_cast<double>(record.FrameCount())},
                     {"frames_unusable", unusable}};
  for (const auto& [name, value] : measures) outcome.numbers.emplace_back(name, value);
  return outcome;
}

CaseOutcome OutcomeOf(const CalibrationRecord& record) {
  CaseOutcome outcome;
  outcome.done = record.usable;
  if (!record.usable) outcome.message = record.message;
  auto& numbers = outcome.numbers;
  numbers = {{"rms_over_sigma", record.rms}, {"start_rms_over_sigma", record.start_rms}};
  for (const FittedRecording& recording : record.recordings) {
    const auto add = [&](const char* kind, const MisfitMeasure& measure) {
      if (measure.frames == 0) return;
      numbers.emplace_back(fmt::format("{}.{}_rms_m", recording.name, kind), measure.rms);
      numbers.emplace_back(fmt::format("{}.{}_rms_over_sigma", recording.name, kind),
                           measure.rms_over_sigma);
    };
    add("fitted", recording.in_fit);
    add("held_out", recording.held_out);
  }
  for (const FittedParameter& parameter : record.parameters) {
    const std::string unit = parameter.unit.empty() ? "" : "_" + parameter.unit;
    numbers.emplace_back(parameter.name + unit, parameter.estimate.value);
    numbers.emplace_back(parameter.name + "_at_limit" + unit,
                         parameter.at_limit.value_or(kNotMeasured));
    numbers.emplace_back(parameter.name + "_low" + unit, parameter.estimate.low);
    numbers.emplace_back(parameter.name + "_high" + unit, parameter.estimate.high);
    outcome.words.emplace_back(parameter.name + "_verdict",
                               DeterminationName(parameter.estimate.determination));
  }
  numbers.emplace_back("predictions", record.predictions);
  numbers.emplace_back("nodes", static_cast<double>(record.mesh.node_count));
  numbers.emplace_back("tetrahedra", static_cast<double>(record.mesh.tet_count));
  return outcome;
}

const std::vector<std::pair<std::string, SweepCommand>>& SweepCommands() {
  static const std::vector<std::pair<std::string, SweepCommand>> commands = {
      {"reconstruct", SweepCommand::kReconstruct},
      {"fit", SweepCommand::kFit},
      {"outer_search", SweepCommand::kOuterSearch},
      {"table1", SweepCommand::kTable1}};
  return commands;
}

std::string NameOf(SweepCommand command) {
  for (const auto& [name, value] : SweepCommands())
    if (value == command) return name;
  LOG(FATAL) << "a command without a name";
}

void CheckCase(SweepCommand command, const CaseFiles& files, const std::filesystem::path& folder) {
  std::vector<Config> configs;
  for (const auto& [name, text] : files)
    configs.push_back(Config::Parse(text, (folder / name).string()));
  CHECK(!configs.empty());
  switch (command) {
    case SweepCommand::kReconstruct:
      ReadReconstruction(configs.front());
      return;
    case SweepCommand::kFit:
      ReadPredictionStudy(configs.front());
      return;
    case SweepCommand::kOuterSearch:
      ReadTable1(configs);
      SearchSeed(configs.front());
      return;
    case SweepCommand::kTable1:
      ReadTable1(ByRow(configs));
      return;
  }
}

CaseOutcome RunCommand(SweepCommand command, const SweepSettings& settings,
                       const std::filesystem::path& folder, Progress* progress) {
  if (command == SweepCommand::kTable1) return Table1(settings, folder, progress);
  const Config experiment = Config::Load(folder / "experiment.yaml");
  if (command == SweepCommand::kReconstruct)
    return OutcomeOf(RunReconstruction(ReadReconstruction(experiment), progress));
  if (command == SweepCommand::kFit)
    return OutcomeOf(RunCalibration(ReadPredictionStudy(experiment), progress));
  return RunCaseSearch(experiment, folder, progress);
}

}  // namespace lacuna
