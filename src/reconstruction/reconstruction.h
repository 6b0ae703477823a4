// From a recording to a model with per-step forces that follows it: the paper's pipeline.
//
//   points → surface → registered frames → tet mesh → trajectory with forces → measures → files
#ifndef LACUNA_RECONSTRUCTION_RECONSTRUCTION_H_
#define LACUNA_RECONSTRUCTION_RECONSTRUCTION_H_

#include "core/progress.h"
#include "reconstruction/reconstruction_study.h"
#include "record/run_record.h"

namespace lacuna {

// Runs what is not yet in the run directory. Throws InputError for input that turns out unusable
// (file and frame named) and Interrupted; numerical outcomes stand in the record.
RunRecord RunReconstruction(const ReconstructionStudy& study, Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_RECONSTRUCTION_H_
