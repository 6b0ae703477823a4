// The paper's pipeline, from a recording to a model with per-step forces that follows it.
//
//   points → surface → registered frames → tet mesh → trajectory with forces → measures → files
#ifndef LACUNA_RECONSTRUCTION_RECONSTRUCTION_H_
#define LACUNA_RECONSTRUCTION_RECONSTRUCTION_H_

#include "core/progress.h"
#include "reconstruction/reconstruction_study.h"
#include "record/run_record.h"

namespace lacuna {

// Runs the stages that are not yet in the run directory. Throws Interrupted, and InputError, which
// names file and frame, for unusable input. Numerical failures are reported in the record.
RunRecord RunReconstruction(const ReconstructionStudy& study, Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_RECONSTRUCTION_H_
