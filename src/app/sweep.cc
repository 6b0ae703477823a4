// lacuna sweep plan | run | collect
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "app/commands.h"
#include "core/error.h"
#include "core/memory_limit.h"
#include "core/parallel.h"
#include "sweep/slurm.h"
#include "sweep/sweep_plan.h"
#include "sweep/sweep_run.h"
#include "sweep/sweep_table.h"

namespace lacuna {
namespace {

struct Arguments {
  std::string sweep_file, folder;
  std::string launcher = "local";
  int workers = 0;
  std::vector<int> numbers;
  bool retry_failed = false;
  bool wait = false;
  std::vector<std::string> sbatch;
};

int Plan(const Arguments& arguments) {
  const SweepPlan plan = PlanSweep(Config::Load(arguments.sweep_file), arguments.folder);
  fmt::print("{}: {} cases, {} of them new; cases.csv lists them\n", arguments.folder,
             plan.cases.size(), plan.added);
  if (!plan.absent.empty())
    fmt::print("cases that are no longer in {}, but were kept: {}\n", arguments.sweep_file,
               fmt::join(plan.absent, ", "));
  return 0;
}

int Submit(const Arguments& arguments) {
  SlurmOptions options;
  options.program = std::filesystem::read_symlink("/proc/self/exe");
  SweepRunOptions chosen;
  chosen.numbers = arguments.numbers;
  chosen.retry_failed = arguments.retry_failed;
  options.numbers = UnfinishedCases(arguments.folder, chosen);
  if (options.numbers.empty()) {
    fmt::print("{}: there is no case left to run\n", arguments.folder);
    return 0;
  }
  options.at_a_time = arguments.workers;
  options.retry_failed = arguments.retry_failed;
  options.memory_limit = GivenMemoryLimit();
  options.wait = arguments.wait;
  options.options = arguments.sbatch;
  const std::string job = SubmitToSlurm(arguments.folder, options);
  fmt::print("Slurm job {}: {} tasks; `squeue -j {}` and `lacuna sweep collect {}` show them\n",
             job, options.numbers.size(), job, arguments.folder);
  if (!arguments.wait) return 0;
  chosen.retry_failed = true;  // a failed case counts as unfinished
  return UnfinishedCases(arguments.folder, chosen).empty() ? 0 : 1;
}

int Run(const Arguments& arguments) {
  if (arguments.launcher == "slurm") return Submit(arguments);
  if (arguments.wait || !arguments.sbatch.empty())
    throw InputError("--wait and --sbatch need --launcher slurm");
  SweepRunOptions options;
  const int cores = ThreadCount();
  options.workers = arguments.workers > 0        ? arguments.workers
                    : !arguments.numbers.empty() ? 1
                                                 : cores;
  options.threads = std::max(1, cores / options.workers);
  options.numbers = arguments.numbers;
  options.retry_failed = arguments.retry_failed;
  const int unfinished = RunSweep(arguments.folder, options);
  if (unfinished > 0)
    fmt::print(stderr, "{} cases are unfinished; `lacuna sweep collect {}` shows why\n", unfinished,
               arguments.folder);
  return unfinished > 0 ? 1 : 0;
}

int Collect(const Arguments& arguments) {
  const SweepTable table = CollectSweep(arguments.folder);
  WriteTable(table, arguments.folder);
  fmt::print("{}The table was written to {}: table.txt, table.csv, table.json\n",
             TableInWords(table), arguments.folder);
  return 0;
}

}  // namespace

void AddSweep(CLI::App* app, std::function<int()>* command) {
  CLI::App* sweep = app->add_subcommand(
      "sweep", "Run many experiments: plan the cases, run them, collect their results");
  sweep->footer(
      "docs/sweep.md explains the sweep file; experiments/sweeps/bend_grid.yaml is an example.\n"
      "Each command can be repeated: plan adds new cases, and run continues with unfinished ones.\n"
      "Several machines that share the folder may run cases at the same time.");
  sweep->require_subcommand(1);
  auto arguments = std::make_shared<Arguments>();
  const auto becomes = [command, arguments](int (*function)(const Arguments&)) {
    return [command, arguments, function] {
      *command = [arguments, function] { return function(*arguments); };
    };
  };
  CLI::App* plan =
      sweep->add_subcommand("plan", "Make a folder with one case for each combination of values");
  plan->add_option("sweep", arguments->sweep_file, "The sweep's YAML file")->required();
  plan->add_option("folder", arguments->folder, "Folder of the cases")->required();
  plan->callback(becomes(&Plan));

  CLI::App* run = sweep->add_subcommand("run", "Run the cases that have no outcome yet");
  run->add_option("folder", arguments->folder, "Folder of the cases")->required();
  run->add_option("--launcher", arguments->launcher, "Where to run: local (default) or slurm")
      ->check(CLI::IsMember({"local", "slurm"}));
  run->add_option(
         "--workers", arguments->workers,
         "Cases to run at the same time (local: one per core; slurm: as many as it allows)")
      ->check(CLI::Range(1, 100000));
  run->add_option("--case", arguments->numbers, "Run only these cases, by number: --case 3,7")
      ->delimiter(',')
      ->allow_extra_args(false);
  run->add_flag("--retry-failed", arguments->retry_failed, "Run failed cases again");
  run->add_flag("--wait", arguments->wait, "slurm: wait until the job has ended");
  run->add_option("--sbatch", arguments->sbatch,
                  "slurm: a further option for sbatch, such as --sbatch=--time=60")
      ->allow_extra_args(false);
  run->callback(becomes(&Run));

  CLI::App* collect =
      sweep->add_subcommand("collect", "Collect the results of all cases in one table");
  collect->add_option("folder", arguments->folder, "Folder of the cases")->required();
  collect->callback(becomes(&Collect));
}

}  // namespace lacuna
