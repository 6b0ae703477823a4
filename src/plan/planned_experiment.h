// Writes a planned recording as files: what is to be done, and an experiment that takes the result.
//
//   <folder>/protocol.yaml    the fitted model with the planned recording alone: `lacuna simulate`
//                             plays it
//   <folder>/predicted        the recording as the fitted model predicts it: its clamp paths, loads
//                             and markers
//   <folder>/experiment.yaml  the experiment NAME of the run with one more recording,
//                             <folder>/measured, which is still to be made: `lacuna fit` takes it.
//                             Its name is NAME-with-PROTOCOL
//   <folder>/object.msh       the undeformed object, to which the predicted recording refers
#ifndef LACUNA_PLAN_PLANNED_EXPERIMENT_H_
#define LACUNA_PLAN_PLANNED_EXPERIMENT_H_

#include <filesystem>

#include "calibration/calibration_run.h"
#include "plan/protocol.h"

namespace lacuna {

// The folder's name in the plan: that of the protocol as a name of a file.
std::filesystem::path FolderOf(const Protocol& protocol);

// Simulates the protocol with the fitted model and the time step `time_step`, s, and writes the
// files. What is in <folder>/measured is left alone. Throws InputError where the protocol cannot be
// made or played, where the model cannot be written as YAML, or where a file cannot be written;
// Interrupted.
void WritePlannedExperiment(const FittedRun& fitted, double time_step, const Protocol& protocol,
                            const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_PLAN_PLANNED_EXPERIMENT_H_
