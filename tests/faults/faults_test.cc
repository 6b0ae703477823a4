#include "faults/faults.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// The short form of lacuna-faults.
TEST(Faults, AFitSurvivesThem) {
  const TemporaryFolder folder;
  FaultOptions options;
  options.program = LACUNA_PROGRAM;
  options.sources = LACUNA_SOURCE_DIR;
  options.folder = folder / "runs";
  for (const Subject& subject : BundledSubjects()) {
    if (subject.name != "fit") continue;
    const std::vector<FaultResult> results = TryFaults(subject, options);
    EXPECT_GE(results.size(), 8u);
    for (const FaultResult& one : results) {
      EXPECT_GT(one.trials, 0) << one.fault;
      EXPECT_EQ(one.survived, one.trials) << one.fault << ": " << one.first_failure;
    }
  }
}

}  // namespace
}  // namespace lacuna
