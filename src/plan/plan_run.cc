#include "plan/plan_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "calibration/calibration_run.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "diagnosis/diagnosis_run.h"
#include "plan/planned_experiment.h"
#include "plan/planner.h"
#include "plan/protocol_reader.h"

namespace lacuna {
namespace {

// What is tried, and where the user's own protocols stand in their file.
struct Tried {
  std::vector<Protocol> protocols;  // the user's own ones first
  std::vector<Config> items;        // of the own ones
};

bool IsNamed(const std::string& name, const std::vector<Protocol>& protocols) {
  return std::any_of(protocols.begin(), protocols.end(),
                     [&](const Protocol& protocol) { return protocol.name == name; });
}

Tried ProtocolsFor(const FittedRun& fitted, const std::optional<std::filesystem::path>& file) {
  if (!file) return {StockProtocols(fitted.study, fitted.mesh), {}};
  ProtocolFile own = ReadProtocols(Config::Load(*file), fitted.study);
  Tried tried{std::move(own.protocols), std::move(own.items)};
  if (own.stock)
    for (Protocol& stock : StockProtocols(fitted.study, fitted.mesh))
      if (!IsNamed(stock.name, tried.protocols)) tried.protocols.push_back(std::move(stock));
  return tried;
}

// Puts the position in the user's file before the reason why a protocol cannot be played.
void SayWhere(const Tried& tried, std::vector<PlannedOutcome>* outcomes) {
  for (PlannedOutcome& outcome : *outcomes) {
    for (size_t k = 0; k < tried.items.size() && !outcome.IsPlayable(); ++k) {
      if (tried.protocols[k].name != outcome.name) continue;
      try {
        tried.items[k].Fail("", outcome.message);
      } catch (const InputError& problem) {
        outcome.message = problem.what();
      }
    }
  }
}

const Protocol& Named(const std::string& name, const std::vector<Protocol>& protocols) {
  return *std::find_if(protocols.begin(), protocols.end(),
                       [&](const Protocol& protocol) { return protocol.name == name; });
}

}  // namespace

std::filesystem::path PlanFile(const std::filesystem::path& run) {
  return run / "plan" / "plan.json";
}

PlanRecord RunPlan(const std::filesystem::path& run,
                   const std::optional<std::filesystem::path>& protocols, Progress* progress) {
  const FittedRun fitted = OpenRun(run);
  const std::optional<KeptDiagnosis> diagnosis = FindDiagnosis(run);
  const std::filesystem::path of_run = run / "diagnosis" / "diagnosis.json";
  if (!diagnosis && std::filesystem::exists(of_run))
    throw InputError({of_run.string()},
                     fmt::format("is of an earlier fit or of another version of the program, or "
                                 "was changed; `lacuna diagnose {}` makes a new one",
                                 run.string()));
  if (!diagnosis)
    throw InputError(fmt::format("{}: its fit has not been diagnosed; `lacuna diagnose {}` does it",
                                 run.string(), run.string()));
  const Tried tried = ProtocolsFor(fitted, protocols);
  PlanRecord plan =
      MakePlan({fitted, diagnosis->record, diagnosis->decision}, tried.protocols, progress);
  plan.diagnosis = HashFile(of_run);
  SayWhere(tried, &plan.outcomes);
  const std::filesystem::path folder = PlanFile(run).parent_path();
  MakeFolder(folder);
  // First without the experiment, because its files may fail to be written.
  WritePlanFile(plan, PlanFile(run));
  if (PlannedOutcome& best = plan.outcomes.front(); best.IsPlayable()) {
    const Protocol& protocol = Named(best.name, tried.protocols);
    WritePlannedExperiment(fitted, diagnosis->record.time_step, protocol,
                           folder / FolderOf(protocol));
    best.experiment = (FolderOf(protocol) / "experiment.yaml").string();
    WritePlanFile(plan, PlanFile(run));
  }
  return plan;
}

}  // namespace lacuna
