#include "comparison/unexplained_force.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/calibration_fits.h"
#include "calibration/calibration_problem.h"
#include "support/held_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// Of the recording of a bar, with a model whose damping is the truth's; mesh and step are coarser,
// and the stiffness is what such a mesh needs to move like the truth (calibration_problem_test).
UnexplainedForce ForceOn(const HeldBarTruth& truth) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar(truth));
  const PredictionStudy study = ReadBarStudy(
      folder.Path(), {{"fit: {parameters: [{name: young_modulus}, {name: mass_damping.alpha}]}",
                       "fit: {parameters: []}"},
                      {"young_modulus: 0.15 MPa", "young_modulus: 0.1 MPa"},
                      {"alpha: 1 1/s", "alpha: 2 1/s"},
                      {"motion: {time_step: 1.5 ms}", "motion: {time_step: 2 ms}"}});
  const CalibrationProblem problem(study, BarMesh({6, 2, 2}, 2));
  ProgressOptions silent;
  silent.style = ProgressStyle::kSilent;
  Progress progress(silent);
  const Calibration calibration = FitFromStart(problem, &progress);
  EXPECT_TRUE(calibration.usable) << calibration.message;
  const RecordingModel model = problem.ModelAt(0, calibration.parameters);
  const ReplayedMotion motion = Replay(model, problem.NuisanceOf(0, calibration.parameters));
  EXPECT_TRUE(motion.summary.IsUsable()) << motion.summary.message;
  return EstimateUnexplainedForce(model, motion, problem.noise(), study.place_deviation);
}

// Rms over time of one component's error.
double Error(const UnexplainedForce& force, const HeldBarTruth& truth, int axis) {
  double squares = 0;
  for (Eigen::Index k = 0; k < force.times.size(); ++k)
    squares += std::pow(force.force(axis, k) - truth.body_force(force.times[k])[axis], 2);
  return std::sqrt(squares / static_cast<double>(force.times.size()));
}

TEST(UnexplainedForce, IsWithinItsUncertaintyWhereNothingIsMissing) {
  const UnexplainedForce force = ForceOn({});
  ASSERT_TRUE(force.usable) << force.message;
  EXPECT_TRUE(force.converged);
  EXPECT_FALSE(force.stands_out);
  // Deviations: what is left of the mesh's error goes into it too.
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_LT(force.rms[axis], 2 * force.rms_deviation[axis]) << axis;
  EXPECT_LT(force.rms_deviation.norm(), 0.03 * force.weight);  // and it says something
  EXPECT_LT(std::abs(force.work), 2 * force.work_deviation);
}

TEST(UnexplainedForce, FindsAHiddenBodyForce) {
  HeldBarTruth truth;
  truth.body_force = [](double time) {
    return Eigen::Vector3d(0, 0.04 * std::sin(30 * time), 0.03 * std::cos(20 * time));
  };
  const UnexplainedForce force = ForceOn(truth);
  ASSERT_TRUE(force.usable) << force.message;
  EXPECT_TRUE(force.converged);
  EXPECT_TRUE(force.stands_out);
  EXPECT_GT(force.in_noise_before, 5);
  // The second bending mode rings on, at a frequency that the coarser mesh has a little higher.
  EXPECT_LT(force.in_noise_after, 1.7);
  // Aside: within a third of its amplitude. Along the weight a steady part is nearly the
  // markers' places, or a pull along the sagging bar: within three deviations.
  EXPECT_LT(Error(force, truth, 1), 0.33 * 0.04);
  EXPECT_LT(Error(force, truth, 2), 3 * force.rms_deviation[2]);
  EXPECT_LT(Error(force, truth, 0), 3 * force.rms_deviation[0]);
  EXPECT_LT(force.rms_deviation[1], 0.25 * 0.04);
}

// A damping that the model lacks is a force against the velocity that drains the motion.
TEST(UnexplainedForce, OfAMissingDampingGoesAgainstTheVelocity) {
  HeldBarTruth truth;
  truth.alpha = 8;  // 1/s; the model has 2
  const UnexplainedForce force = ForceOn(truth);
  ASSERT_TRUE(force.usable) << force.message;
  EXPECT_TRUE(force.stands_out);
  ASSERT_EQ(force.likeness[1].what, "velocity");
  EXPECT_LT(force.likeness[1].correlation, -0.5);
  EXPECT_LT(force.work, -2 * force.work_deviation);
}

}  // namespace
}  // namespace lacuna
