// The stage "mesh" of a run, whose result is the undeformed body.
#ifndef LACUNA_EXPERIMENT_REFERENCE_BODY_STAGE_H_
#define LACUNA_EXPERIMENT_REFERENCE_BODY_STAGE_H_

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "core/progress.h"
#include "experiment/reference_body.h"
#include "record/run_directory.h"

namespace lacuna {

// Reads the body from the run directory or, where none is there for this `configuration` and these
// hashes of what stands `behind` it (StageIdentity), takes it from `make` and stores it. Throws
// what `make` throws.
ReferenceBody RunReferenceBodyStage(RunDirectory* run, const nlohmann::json& configuration,
                                    const std::map<std::string, std::string>& behind,
                                    Progress* progress, const std::function<ReferenceBody()>& make);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_REFERENCE_BODY_STAGE_H_
