#include "plan/plan_run.h"

#include <fmt/format.h>

#include <vector>

#include "calibration/calibration_run.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "diagnosis/diagnosis_run.h"
#include "plan/planner.h"
#include "plan/protocol_reader.h"

namespace lacuna {
namespace {

std::vector<Protocol> ProtocolsFor(const FittedRun& fitted,
                                   const std::optional<std::filesystem::path>& file) {
  if (!file) return StockProtocols(fitted.study, fitted.mesh);
  const ProtocolFile own = ReadProtocols(Config::Load(*file), fitted.study);
  std::vector<Protocol> protocols = own.protocols;
  if (own.stock)
    for (Protocol& stock : StockProtocols(fitted.study, fitted.mesh))
      protocols.push_back(std::move(stock));
  return protocols;
}

}  // namespace

std::filesystem::path PlanFile(const std::filesystem::path& run) {
  return run / "plan" / "plan.json";
}

PlanRecord RunPlan(const std::filesystem::path& run,
                   const std::optional<std::filesystem::path>& protocols, Progress* progress) {
  const FittedRun fitted = OpenRun(run);
  const std::optional<KeptDiagnosis> diagnosis = FindDiagnosis(run);
  if (!diagnosis)
    throw InputError(fmt::format("{}: its fit has not been diagnosed; `lacuna diagnose {}` does it",
                                 run.string(), run.string()));
  const PlanRecord plan = MakePlan({fitted, diagnosis->record, diagnosis->decision},
                                   ProtocolsFor(fitted, protocols), progress);
  MakeFolder(PlanFile(run).parent_path());
  WritePlanFile(plan, PlanFile(run));
  return plan;
}

}  // namespace lacuna
