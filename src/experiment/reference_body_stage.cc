#include "experiment/reference_body_stage.h"

#include <fmt/format.h>

#include "record/run_stage.h"

namespace lacuna {
namespace {

// Incremented whenever a change of the code changes the result of the stage, or its files.
constexpr int kReferenceBodyVersion = 3;

}  // namespace

ReferenceBody RunReferenceBodyStage(RunDirectory* run, const nlohmann::json& configuration,
                                    const std::map<std::string, std::string>& behind,
                                    Progress* progress,
                                    const std::function<ReferenceBody()>& make) {
  return RunStage<ReferenceBody>(
      run, {"mesh", kReferenceBodyVersion, configuration, behind}, progress,
      [&] {
        progress->Begin("mesh", 0);
        ReferenceBody body = make();
        progress->End(
            fmt::format("{} nodes, {} tetrahedra", body.mesh.NodeCount(), body.mesh.TetCount()));
        return body;
      },
      WriteReferenceBody, ReadReferenceBody);
}

}  // namespace lacuna
