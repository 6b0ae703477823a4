#include "comparison/force_estimate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/calibration_fits.h"
#include "calibration/calibration_problem.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// The unexplained force for a simulated recording of a bar. The model has the damping of `truth`'s
// default; its mesh and time step are coarser, and its stiffness is fitted so that the coarse mesh
// moves like the truth (calibration_problem_test).
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
  SilentProgress progress;
  const Calibration calibration = FitFromStart(problem, &progress);
  EXPECT_TRUE(calibration.usable) << calibration.message;
  const RecordingModel model = problem.ModelAt(0, calibration.parameters);
  const ReplayedMotion motion = Replay(model, problem.NuisanceOf(0, calibration.parameters));
  EXPECT_TRUE(motion.summary.IsUsable()) << motion.summary.message;
  return EstimateUnexplainedForce(model, motion, problem.ErrorsOf(model));
}

// Rms over time of the error of one component of the net force.
double Error(const ForceHistory& history, const HeldBarTruth& truth, int axis) {
  double squares = 0;
  for (Eigen::Index k = 0; k < history.times.size(); ++k)
    squares += std::pow(history.force(axis, k) - truth.body_force(history.times[k])[axis], 2);
  return std::sqrt(squares / static_cast<double>(history.times.size()));
}

TEST(ForceEstimate, IsWithinItsUncertaintyIfTheModelIsComplete) {
  const UnexplainedForceRecord force = ForceOn({}).record;
  ASSERT_TRUE(force.usable) << force.message;
  EXPECT_TRUE(force.fit.converged);
  EXPECT_FALSE(force.fit.is_significant);
  // Two deviations, because the remaining error of the mesh contributes to the force.
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_LT(force.net.rms[axis], 2 * force.net.rms_deviation[axis]) << axis;
  EXPECT_LT(force.net.rms_deviation.norm(), 0.03 * force.net.weight);  // a useful upper limit
  EXPECT_LT(std::abs(force.work.work), 2 * force.work.deviation);
}

TEST(ForceEstimate, FindsAHiddenBodyForce) {
  HeldBarTruth truth;
  truth.body_force = [](double time) {
    return Eigen::Vector3d(0, 0.04 * std::sin(30 * time), 0.03 * std::cos(20 * time));
  };
  const UnexplainedForce found = ForceOn(truth);
  const UnexplainedForceRecord& force = found.record;
  ASSERT_TRUE(force.usable) << force.message;
  EXPECT_TRUE(force.fit.converged);
  EXPECT_TRUE(force.fit.is_significant);
  EXPECT_GT(force.fit.rms_over_sigma_without, 5);
  // The second bending mode rings on, at a frequency that is a little higher with the coarser mesh.
  EXPECT_LT(force.fit.rms_over_sigma_with, 1.7);
  // Sideways: within a third of the amplitude. Along the weight, a steady force can hardly be
  // distinguished from an error of the markers' places, nor along the sagging bar from a pull:
  // within three deviations.
  EXPECT_LT(Error(found.history, truth, 1), 0.33 * 0.04);
  EXPECT_LT(Error(found.history, truth, 2), 3 * force.net.rms_deviation[2]);
  EXPECT_LT(Error(found.history, truth, 0), 3 * force.net.rms_deviation[0]);
  EXPECT_LT(force.net.rms_deviation[1], 0.25 * 0.04);
}

// Damping that the model lacks is a force against the velocity, which removes energy.
TEST(ForceEstimate, OpposesTheVelocityIfDampingIsMissing) {
  HeldBarTruth truth;
  truth.alpha = 8;  // 1/s; the model has 2
  const UnexplainedForceRecord force = ForceOn(truth).record;
  ASSERT_TRUE(force.usable) << force.message;
  EXPECT_TRUE(force.fit.is_significant);
  ASSERT_EQ(force.correlations[1].quantity, "velocity");
  EXPECT_LT(force.correlations[1].correlation, -0.5);
  EXPECT_LT(force.work.work, -2 * force.work.deviation);
}

}  // namespace
}  // namespace lacuna
