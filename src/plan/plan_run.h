// Plans the next recording of a run that was fitted and diagnosed, and keeps the plan in
// <run>/plan.
#ifndef LACUNA_PLAN_PLAN_RUN_H_
#define LACUNA_PLAN_PLAN_RUN_H_

#include <filesystem>
#include <optional>

#include "core/progress.h"
#include "record/plan_record.h"

namespace lacuna {

// The file of <run>/plan that RunPlan() writes.
std::filesystem::path PlanFile(const std::filesystem::path& run);

// Plays the stock protocols (protocol.h), those of the file `protocols` (protocol_reader.h), or
// both (one of the file replaces a stock one of its name), and writes plan.json and the files of
// the best one (planned_experiment.h). The reason why a protocol of the file cannot be played
// begins with its position there. Throws InputError when the run is not fitted or not diagnosed,
// when nothing is left to be decided, for errors in `protocols`, and when the files of the best one
// cannot be written: plan.json is kept then, without the name of its experiment. Interrupted.
PlanRecord RunPlan(const std::filesystem::path& run,
                   const std::optional<std::filesystem::path>& protocols, Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_PLAN_PLAN_RUN_H_
