// One stage of a run.
#ifndef LACUNA_RECORD_RUN_STAGE_H_
#define LACUNA_RECORD_RUN_STAGE_H_

#include <filesystem>

#include "core/progress.h"
#include "record/run_directory.h"

namespace lacuna {

// Reads the result of a stage from the run directory, or computes and stores it if it is not there.
template <typename Value, typename Compute, typename Save, typename Read>
Value RunStage(RunDirectory* run, const StageIdentity& identity, Progress* progress,
               const Compute& compute, const Save& save, const Read& read) {
  const std::string key = StageKey(identity);
  if (run->Has(identity.stage, key)) {
    progress->Begin(identity.stage, 0);
    Value value = read(run->StageFolder(identity.stage));
    progress->End("resumed");
    return value;
  }
  Value value = compute();
  run->Store(identity.stage, key,
             [&](const std::filesystem::path& folder) { save(value, folder); });
  return value;
}

}  // namespace lacuna

#endif  // LACUNA_RECORD_RUN_STAGE_H_
