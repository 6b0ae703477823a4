#include "faults/faults.h"

#include <gtest/gtest.h>

#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// The short form of lacuna-faults, for the subject of this name. The others take minutes.
void ExpectSurvival(const std::string& name) {
  const TemporaryFolder folder;
  FaultOptions options;
  options.program = LACUNA_PROGRAM;
  options.sources = LACUNA_SOURCE_DIR;
  options.folder = folder / "runs";
  options.faketime = FindFaketime();
  int subjects = 0;
  for (const Subject& subject : BundledSubjects()) {
    if (subject.name != name) continue;
    ++subjects;
    const std::vector<FaultResult> results = TryFaults(subject, options);
    EXPECT_GE(results.size(), 12u);
    for (const FaultResult& one : results) {
      if (!one.note.starts_with("skipped")) {
        EXPECT_GT(one.trials, 0) << one.fault;
      }
      EXPECT_EQ(one.survived, one.trials) << one.fault << ": " << one.first_failure;
    }
  }
  EXPECT_EQ(subjects, 1);
}

TEST(Faults, AFitSurvivesThem) { ExpectSurvival("fit"); }

}  // namespace
}  // namespace lacuna
