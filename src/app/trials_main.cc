// lacuna-trials: makes sealed cases, synthetic recordings with a known missing effect, diagnoses
// them without knowing it, and reports how often the diagnosis was right.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <optional>

#include "app/command_documents.h"
#include "app/program.h"
#include "core/blas_kernels.h"
#include "core/interrupt.h"
#include "core/logging.h"
#include "trials/case_files.h"
#include "trials/follow_up.h"
#include "trials/interval_trials.h"
#include "trials/trial_report.h"
#include "trials/trial_run.h"
#include "trials/trial_suite.h"

namespace lacuna {
namespace {

void Report(const std::filesystem::path& folder) {
  const TrialReport report = ReportTrials(folder);
  WriteTrialReport(report, folder);
  fmt::print("{}", ReportInWords(report));
}

void Redecide(const std::filesystem::path& folder) {
  int decided = 0;
  for (const std::filesystem::path& own : CasesIn(folder)) {
    const TrialCase trial = ReadCase(own);
    decided += RedecideOutcome(trial, own);
    for (const std::filesystem::path& follow_up : FollowUpFolders(own))
      RedecideOutcome(trial, follow_up);
  }
  fmt::print("{} cases decided\n", decided);
}

bool Intervals(const std::filesystem::path& suite, const std::filesystem::path& folder,
               int workers) {
  const bool done = RunIntervalSuite(ReadIntervalSuite(Config::Load(suite)), folder, workers);
  if (!done) return false;
  const IntervalReport report = ReportIntervals(folder);
  WriteIntervalReport(report, folder);
  fmt::print("{}", IntervalReportInWords(report));
  return true;
}

int Main(int argc, char** argv) {
  CLI::App app(
      "Tests the diagnosis on sealed cases: simulated recordings, most of them with an effect that "
      "the model lacks; the diagnosis is not told which");
  app.footer(
      "Exit status: 0 done; 1 the process of a case has failed; 2 unusable input;\n"
      "130 stopped by Ctrl-C (run the same command again to resume).");
  app.require_subcommand(1);
  AddMemoryLimitOption(&app);
  std::string suite, folder;
  int workers = 2;
  CLI::App* make = app.add_subcommand("make", "Make the cases of a suite");
  make->add_option("suite", suite, "The suite's YAML file, experiments/trials/*.yaml")->required();
  make->add_option("folder", folder, "Folder for the cases")->required();
  CLI::App* run = app.add_subcommand("run", "Diagnose the cases that have no outcome yet");
  run->add_option("folder", folder, "Folder of the cases")->required();
  CLI::App* follow = app.add_subcommand(
      "follow",
      "For each case left open, simulate the recording that the plan proposes, and diagnose again");
  follow->add_option("folder", folder, "Folder of the cases")->required();
  CLI::App* redecide = app.add_subcommand(
      "redecide", "Apply the present decision rules to the stored evidence, and report");
  redecide->add_option("folder", folder, "Folder of the cases")->required();
  CLI::App* report = app.add_subcommand("report", "Report how often the diagnosis was right");
  report->add_option("folder", folder, "Folder of the cases")->required();
  CLI::App* intervals = app.add_subcommand(
      "intervals", "Count how often the intervals of a fit contain the true values");
  intervals->add_option("suite", suite, "The suite's YAML file, experiments/trials/intervals*.yaml")
      ->required();
  intervals->add_option("folder", folder, "Folder for the random draws")->required();
  for (CLI::App* command : {make, run, follow, intervals})
    command
        ->add_option("--workers", workers,
                     "Number of processes to run at the same time (default: 2)")
        ->check(CLI::Range(1, 64));
  AddDocumentOption(&app);
  if (const std::optional<int> ended = ParseCommandLine(&app, argc, argv)) return *ended;
  return ExitStatusOf("lacuna-trials", [&] {
    bool done = true;
    if (make->parsed()) done = MakeTrials(ReadTrialSuite(Config::Load(suite)), folder, workers);
    if (run->parsed()) done = RunTrials(folder, workers);
    if (follow->parsed()) done = RunFollowUps(folder, workers);
    if (intervals->parsed()) done = Intervals(suite, folder, workers);
    ThrowIfInterrupted();  // the cases that were running have stopped, and others were not begun
    if (redecide->parsed()) Redecide(folder);
    if (redecide->parsed() || report->parsed()) Report(folder);
    return done ? 0 : 1;
  });
}

}  // namespace
}  // namespace lacuna

int main(int argc, char** argv) {
  lacuna::UseFastBlasKernels(argv);
  lacuna::InitialiseLogging(argv[0]);
  lacuna::InstallInterruptHandler();
  return lacuna::Main(argc, argv);
}
