// Fits of the held bar, whose stiffness, damping, hold and clock are known.
#include "calibration/held_bar_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "calibration/calibration_fits.h"
#include "calibration/held_out_misfit.h"
#include "support/silent_fit.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

TEST(CalibrationProblem, RecoversWhatWasFilmed) {
  const TemporaryFolder folder;
  const HeldBarTruth truth;
  WriteBarRecording(folder.Path(), FilmHeldBar(truth));
  const PredictionStudy study = ReadBarStudy(folder.Path());
  const CalibrationProblem problem(study, StudyMesh());
  const Calibration fit = FitSilently(problem);
  ASSERT_TRUE(fit.usable) << fit.message;
  const ParameterEstimate& modulus = fit.estimates[0];
  // A coarser mesh of the same elements is 2 % stiffer, longer steps are 1 % slower.
  EXPECT_NEAR(modulus.value, truth.young_modulus, 0.04 * truth.young_modulus);
  EXPECT_EQ(modulus.determination, Determination::kPinnedDown);
  EXPECT_LT(modulus.low, modulus.value);
  EXPECT_GT(modulus.high, modulus.value);
  const double width = modulus.high - modulus.low;
  EXPECT_GT(width, 0.005 * modulus.value);
  EXPECT_LT(width, 0.1 * modulus.value);
  EXPECT_LT(std::abs(modulus.value - truth.young_modulus), width);  // mesh and steps included
  const ParameterEstimate& alpha = fit.estimates[1];
  EXPECT_LT(alpha.low, truth.alpha);
  EXPECT_GT(alpha.high, truth.alpha);
  const Eigen::VectorXd nuisance = problem.NuisanceOf(0, fit.parameters);
  // Within the intervals, some 2 mN and, along the bar, where it moves nothing, 12 mN; 0.5 ms.
  EXPECT_NEAR(nuisance[0], truth.hold_force.x(), 0.015);
  EXPECT_NEAR(nuisance[1], truth.hold_force.y(), 0.003);
  EXPECT_NEAR(nuisance[2], truth.hold_force.z(), 0.003);
  EXPECT_NEAR(nuisance[3], truth.clock, 5e-4);

  EXPECT_LT(fit.rms, 1.3);
  EXPECT_GT(fit.start_rms, 2 * fit.rms);
  const std::vector<RecordingMisfit> misfits = MisfitsOf(problem, fit.parameters);
  ASSERT_EQ(misfits.size(), 1u);
  EXPECT_EQ(misfits[0].in_fit.frames, 16);  // 0 to 0.15 s
  EXPECT_EQ(misfits[0].held_out.frames, kFrames - 16);
  EXPECT_EQ(misfits[0].held_out.points, (kFrames - 16) * kMarkers);
  EXPECT_LT(misfits[0].in_fit.rms_over_sigma, 1.3);
  // The discretisation shows in the frames that were not fitted: 0.14 mm after 20 mm of motion.
  EXPECT_LT(misfits[0].held_out.rms_over_sigma, 2.5);
  EXPECT_GE(misfits[0].held_out.largest, misfits[0].held_out.rms);
}

// A quarter of the fitted time would be rest, from which nothing could be fitted.
TEST(CalibrationFits, TheFirstPartBeginsWhereTheObjectMoves) {
  const TemporaryFolder folder;
  const std::vector<Eigen::Matrix3Xd> moving = FilmHeldBar({});
  const auto horizon = [&](const std::string& name, int resting) {
    std::vector<Eigen::Matrix3Xd> late = moving;
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, 5e-5);
    for (int frame = 0; frame < resting; ++frame) {
      late[frame] = moving.front();
      for (double& coordinate : late[frame].reshaped()) coordinate += noise(random);
    }
    WriteBarRecording(folder / name, late);
    return ShortHorizon(CalibrationProblem(ReadBarStudy(folder / name), StudyMesh()));
  };
  const double last = 0.15;
  EXPECT_NEAR(horizon("late", 11), 0.1 - kRelease + 0.25 * (last - 0.1), 1e-9);
  // In the 6 ms from its release to the next frame it hardly moves.
  EXPECT_NEAR(horizon("at_once", 0), 0.05 - kRelease + 0.25 * (last - 0.05), 1e-9);
}

}  // namespace
}  // namespace lacuna
