// lacuna plan RUN
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "app/commands.h"
#include "plan/plan_run.h"
#include "report/plan_report.h"

namespace lacuna {
namespace {

struct PlanArguments {
  std::string run, protocols;
};

int RunPlanCommand(const PlanArguments& arguments, const OutputOptions& output) {
  Progress progress(output.ForProgress());
  std::optional<std::filesystem::path> protocols;
  if (!arguments.protocols.empty()) protocols = arguments.protocols;
  const PlanRecord plan = RunPlan(arguments.run, protocols, &progress);
  if (output.json) PrintRecord(PlanFile(arguments.run));
  const bool is_playable = !plan.outcomes.empty() && plan.outcomes.front().IsPlayable();
  if (output.PrintsText()) {
    fmt::print("{}", output.verbose ? PlanReport(plan) : PlanSummary(plan));
    if (is_playable) {
      const std::filesystem::path experiment =
          PlanFile(arguments.run).parent_path() / plan.outcomes.front().experiment;
      fmt::print("\nThe recording is described in {}.\nOnce it is made: lacuna fit {}\n",
                 (experiment.parent_path() / "predicted/recording.yaml").string(),
                 experiment.string());
    }
  }
  return is_playable ? 0 : 1;
}

}  // namespace

void AddPlan(CLI::App* app, OutputOptions* output, std::function<int()>* command) {
  CLI::App* plan = app->add_subcommand(
      "plan", "Find the recording that best tells apart the effects that a diagnosis left open");
  plan->footer(
      "RUN is the folder of a run whose diagnosis has left several effects open. Variants of its\n"
      "recording, such as twice the pull, a turned clamp or an added mass, are simulated with\n"
      "the fitted model; RUN/plan/plan.json says how often each would lead to the right name,\n"
      "and how well the size of each effect would be known.");
  auto arguments = std::make_shared<PlanArguments>();
  plan->add_option("run", arguments->run, "Folder of the run")->required();
  plan->add_option("--protocols", arguments->protocols,
                   "YAML file with variants of your own (docs/plan.md)")
      ->check(CLI::ExistingFile);
  AddPrintOptions(plan, output);
  plan->callback([=] { *command = [=] { return RunPlanCommand(*arguments, *output); }; });
}

}  // namespace lacuna
