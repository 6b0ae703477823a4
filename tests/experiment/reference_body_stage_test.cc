#include "experiment/reference_body_stage.h"

#include <gtest/gtest.h>

#include "support/box_mesh.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

TEST(ReferenceBodyStage, MakesTheBodyOnceForEachConfiguration) {
  const TemporaryFolder folder;
  SilentProgress progress;
  int made = 0;
  const auto run_stage = [&](double max_volume) {
    RunDirectory run(folder / "run");
    const nlohmann::json configuration{{"max_volume", max_volume}};
    run.Begin(configuration, {}, 0);
    return RunReferenceBodyStage(&run, configuration, {}, &progress, [&] {
      ++made;
      return ReferenceBody{BoxMesh({0, 0, 0}, {0.04, 0.03, 0.02}, {2, 1, 1}), {}, {"a note"}};
    });
  };
  const ReferenceBody first = run_stage(1e-6);
  const ReferenceBody again = run_stage(1e-6);
  EXPECT_EQ(made, 1);
  EXPECT_EQ(again.mesh.nodes, first.mesh.nodes);
  EXPECT_EQ(again.notes, first.notes);
  run_stage(2e-6);
  EXPECT_EQ(made, 2);
}

}  // namespace
}  // namespace lacuna
