#include "comparison/force_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "comparison/coarse_bar.h"
#include "support/held_bar.h"
#include "support/replace_in_file.h"
#include "support/silent_fit.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// The unexplained force for a simulated recording of a bar. The model has the damping of `truth`'s
// default; its mesh and time step are coarser, and its stiffness is fitted so that the coarse mesh
// moves like the truth (calibration_problem_test).
UnexplainedForce ForceOn(const HeldBarTruth& truth) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar(truth));
  const PredictionStudy study = ReadCoarseBarStudy(folder.Path());
  const CalibrationProblem problem(study, BarMesh({6, 2, 2}, 2));
  const Calibration calibration = FitSilently(problem);
  EXPECT_TRUE(calibration.usable) << calibration.message;
  const RecordingModel model = problem.ModelAt(0, calibration.parameters);
  const ReplayedMotion motion = Replay(model, problem.NuisanceOf(0, calibration.parameters));
  EXPECT_TRUE(motion.summary.IsUsable()) << motion.summary.message;
  return EstimateUnexplainedForce(model, motion, problem.ErrorsOf(model));
}

// A complete model whose clamp is not where it was said to be: the recording is a prediction with a
// placement far from the mean of its prior, and noise.
TEST(ForceEstimate, KeepsTheFittedPlacementOfAClamp) {
  const TemporaryFolder folder;
  const auto study_of = [&](const std::vector<Eigen::Matrix3Xd>& frames) {
    WriteBarRecording(folder.Path(), frames);
    ReplaceInFile(folder / "recording.yaml", "normal: [-1, 0, 0]}}]",
                  "normal: [-1, 0, 0]}, placement: {shift_deviation: 0.5 mm, turn_deviation: 1 "
                  "deg}}]");
    return ReadBarStudy(folder.Path(),
                        {{"motion: {time_step: 1.5 ms}", "motion: {time_step: 3 ms}"},
                         {"young_modulus: 0.15 MPa", "young_modulus: 0.1 MPa"}});
  };
  std::vector<Eigen::Matrix3Xd> frames = FilmHeldBar({});
  const TetMesh mesh = BarMesh({4, 1, 1}, 2);
  Eigen::VectorXd nuisance;
  {
    const PredictionStudy study = study_of(frames);
    const CalibrationProblem problem(study, mesh);
    const RecordingModel& model = problem.models()[0];
    nuisance = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.nuisances().size()));
    for (size_t k = 0; k < model.nuisances().size(); ++k) {
      const std::string& name = model.nuisances()[k].prior.name;
      if (name == "bar.hold_force_y") nuisance[static_cast<Eigen::Index>(k)] = 0.03;  // N
      if (name == "bar.clamp.shift_z") nuisance[static_cast<Eigen::Index>(k)] = 2e-3;
    }
    ASSERT_GT(nuisance.lpNorm<1>(), 0.03);
    const ReplayedMotion motion = Replay(model, nuisance);
    ASSERT_TRUE(motion.summary.IsUsable()) << motion.summary.message;
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0, 5e-5);
    for (size_t frame = 0; frame < frames.size(); ++frame)
      frames[frame] = motion.predicted.col(static_cast<Eigen::Index>(frame)).reshaped(3, kMarkers) +
                      Eigen::Matrix3Xd::NullaryExpr(3, kMarkers, [&] { return noise(random); });
  }
  const PredictionStudy study = study_of(frames);
  const CalibrationProblem problem(study, mesh);
  const RecordingModel& model = problem.models()[0];
  const UnexplainedForceRecord force =
      EstimateUnexplainedForce(model, Replay(model, nuisance), problem.ErrorsOf(model)).record;
  ASSERT_TRUE(force.usable) << force.message;
  EXPECT_TRUE(force.fit.converged);
  EXPECT_FALSE(force.fit.is_significant);
  EXPECT_LT(force.fit.rms_over_sigma_with, 1.2);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_LT(force.net.rms[axis], 2 * force.net.rms_deviation[axis]) << axis;
}

// An error that has grown is no solution, however close to the noise the prediction is.
TEST(ForceEstimate, DoesNotEndWithAStepThatIncreasesTheError) {
  EXPECT_TRUE(HasConverged(1.1, 0.8, 1.05));
  EXPECT_FALSE(HasConverged(1.1, 0.8, 1.25));
  EXPECT_TRUE(HasConverged(9, 5, 5.3));
  EXPECT_FALSE(HasConverged(9, 5, 6));
  // At the solution, a step changes nothing but digits.
  EXPECT_TRUE(HasConverged(1, 0.9999, 1.0001));
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
  EXPECT_LT(NetForceError(found.history, truth, 1), 0.33 * 0.04);
  EXPECT_LT(NetForceError(found.history, truth, 2), 3 * force.net.rms_deviation[2]);
  EXPECT_LT(NetForceError(found.history, truth, 0), 3 * force.net.rms_deviation[0]);
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
