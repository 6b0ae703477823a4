#include "calibration/step_errors.h"

#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <string>

#include "support/pulled_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// Of a bar that relaxes while it is pulled slowly, with this time_step.
std::optional<StepErrors> ErrorsWithStep(const std::filesystem::path& folder,
                                         const std::string& time_step) {
  const PredictionStudy study = ReadPulledBarStudy(
      folder, {{"time_step: 1 s", "time_step: " + time_step},
               {"motion:",
                "effects: [{type: viscoelastic_branch, modulus: 30 kPa, relaxation_time: 3 s}]\n"
                "motion:"}});
  const CalibrationProblem problem(study, BarMesh({3, 1, 1}, 1));
  const LinearisedMisfit misfit = problem.Linearise(problem.Start(), {});
  EXPECT_TRUE(misfit.usable) << misfit.message;
  return FindStepErrors(problem, problem.Start(), misfit);
}

// The frames are a second apart. Steps end at them, so that a longer time_step is the same as one
// second. Halved twice, 7 s would still be longer than that.
TEST(StepErrors, OfQuasiStaticStepsBeginWithTheDistanceBetweenFrames) {
  const TemporaryFolder folder;
  WritePulledBar(folder.Path(), {});
  const std::optional<StepErrors> one = ErrorsWithStep(folder.Path(), "1 s"),
                                  long_ones = ErrorsWithStep(folder.Path(), "7 s");
  ASSERT_TRUE(one && long_ones);
  EXPECT_GT(one->to_limit.norm(), 0);
  EXPECT_LT((long_ones->to_limit - one->to_limit).norm(), 1e-9 * one->to_limit.norm());
}

}  // namespace
}  // namespace lacuna
