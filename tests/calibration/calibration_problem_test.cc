// The residual of a calibration problem and its Jacobian.
#include "calibration/calibration_problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "calibration/held_bar_fit.h"
#include "calibration/held_out_misfit.h"
#include "calibration/linear_misfit.h"
#include "core/parallel.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

TEST(CalibrationProblem, JacobianAgreesWithDifferences) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study =
      ReadBarStudy(folder.Path(), {{"{name: mass_damping.alpha}",
                                    "{name: poisson_ratio}, {name: mass_damping.alpha}, "
                                    "{name: gravity.acceleration_z}"},
                                   {"clock_deviation: 10 ms\n",
                                    "clock_deviation: 10 ms\n    registration: {shift_deviation: "
                                    "1 mm, turn_deviation: 1 deg}\n"}});
  const CalibrationProblem problem(study, StudyMesh());
  constexpr Eigen::Index kCount = 14;
  std::vector<std::string> names;
  for (const CalibratedParameter& parameter : problem.parameters()) names.push_back(parameter.name);
  EXPECT_THAT(names,
              testing::ElementsAre("young_modulus", "poisson_ratio", "mass_damping.alpha",
                                   "gravity.acceleration_z", "bar.hold_force_x", "bar.hold_force_y",
                                   "bar.hold_force_z", "bar.clock", "bar.shift_x", "bar.shift_y",
                                   "bar.shift_z", "bar.turn_x", "bar.turn_y", "bar.turn_z"));
  EXPECT_EQ(problem.UnitOf(7), "s");
  EXPECT_EQ(problem.UnitOf(13), "rad");
  Eigen::VectorXd at = problem.Start();
  // A turn's derivative is that of a small one.
  at.tail(10) << 0.01, 0.03, -0.02, 0.001, 1e-3, -2e-3, 1e-3, 5e-4, -3e-4, 2e-4;
  const Eigen::VectorXd steps = (Eigen::VectorXd(kCount) << 200, 1e-3, 1e-2, 1e-2, 2e-3, 2e-3, 2e-3,
                                 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4)
                                    .finished();
  // How errors of the markers' places show is what it is at `at`.
  const LinearisedMisfit here = problem.Linearise(at, {.with_jacobian = true});
  ASSERT_TRUE(here.usable) << here.message;
  ASSERT_EQ(here.jacobian.cols(), kCount);
  for (Eigen::Index k = 0; k < kCount; ++k) {
    const Eigen::VectorXd shift = steps[k] * Eigen::VectorXd::Unit(kCount, k);
    const Eigen::VectorXd difference =
        (problem.Linearise(at + shift, {.correspondences = &here}).residual -
         problem.Linearise(at - shift, {.correspondences = &here}).residual) /
        (2 * steps[k]);
    // Truncation, and trajectories that are known to 1e-8 of the forces only.
    EXPECT_LT((here.jacobian.col(k) - difference).norm(), 1e-3 * difference.norm()) << names[k];
  }
  // And the fitted frames of that, whitened, are what is fitted.
  const ResidualEvaluation fitted = problem.Predict(at, true);
  ASSERT_TRUE(fitted.usable) << fitted.message;
  const Eigen::MatrixXd white = WhitenedRows(here.jacobian, here, {.fitted_only = true});
  EXPECT_LT((fitted.jacobian - white.topRows(fitted.jacobian.rows())).norm(),
            1e-6 * fitted.jacobian.norm());
}

// Poisson's ratio of the material, which the branch and the lump share.
TEST(CalibrationProblem, DifferentiatesBySettingsThatFollowTheMaterial) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study = ReadBarStudy(
      folder.Path(),
      {{"  - {type: mass_damping, alpha: 1 1/s}\n",
        "  - {type: viscoelastic_branch, modulus: 100 kPa, relaxation_time: 20 ms}\n"
        "  - {type: inclusion, young_modulus_difference: 100 kPa, centre: [0.02 m, 0, 0], radius: "
        "10 mm}\n"},
       {"{name: young_modulus}, {name: mass_damping.alpha}", "{name: poisson_ratio}"},
       {"    clock_deviation: 10 ms\n", ""}});
  ASSERT_EQ(study.fitted.at(0).places.size(), 3u);
  const CalibrationProblem problem(study, BarMesh({3, 1, 1}, 2));
  Eigen::VectorXd at = problem.Start();
  at.tail<3>() << 0.01, 0.03, -0.02;  // the force of the hold
  constexpr double kStep = 1e-3;
  const Eigen::VectorXd shift = kStep * Eigen::VectorXd::Unit(at.size(), 0);
  const LinearisedMisfit here = problem.Linearise(at, {.with_jacobian = true});
  ASSERT_TRUE(here.usable) << here.message;
  const Eigen::VectorXd difference =
      (problem.Linearise(at + shift, {.correspondences = &here}).residual -
       problem.Linearise(at - shift, {.correspondences = &here}).residual) /
      (2 * kStep);
  // Truncation, and sensitivities that are solved to 1e-4.
  EXPECT_LT((here.jacobian.col(0) - difference).norm(), 2e-3 * difference.norm());
}

// Half of the markers are hidden in every second frame.
TEST(CalibrationProblem, CountsOnlyMarkersThatAreSeen) {
  const TemporaryFolder folder;
  std::vector<Eigen::Matrix3Xd> markers = FilmHeldBar({});
  for (size_t frame = 1; frame < markers.size(); frame += 2)
    for (Eigen::Index m = 1; m < kMarkers; m += 2)
      markers[frame].col(m).setConstant(std::numeric_limits<double>::quiet_NaN());
  WriteBarRecording(folder.Path(), markers);
  const PredictionStudy study = ReadBarStudy(folder.Path());
  const CalibrationProblem problem(study, BarMesh({3, 1, 1}, 1));
  const ResidualEvaluation prediction = problem.Predict(problem.Start(), false);
  ASSERT_TRUE(prediction.usable) << prediction.message;
  constexpr Eigen::Index kFitted = 16;  // frames, 0 to 0.15 s
  ASSERT_EQ(prediction.residual.size(), 3 * kMarkers * kFitted);
  EXPECT_EQ(prediction.unobserved, 3 * (kMarkers / 2) * (kFitted / 2));
  const double seen = 0.75 * static_cast<double>(prediction.residual.size());
  EXPECT_NEAR(RootMeanSquare(prediction), prediction.residual.norm() / std::sqrt(seen), 1e-12);
}

// What a prediction that breaks off would have been compared with binds no later one.
TEST(CalibrationProblem, APredictionThatBreaksOffLeavesNothingBehind) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study = ReadBarStudy(folder.Path());
  const CalibrationProblem problem(study, StudyMesh());
  constexpr double kWhole = std::numeric_limits<double>::infinity();
  CalibrationProblem::FitMemory memory;
  Eigen::VectorXd liquid = problem.Start();
  liquid[0] = 1;  // Pa
  EXPECT_FALSE(problem.Predict(liquid, false, kWhole, &memory).usable);
  EXPECT_TRUE(memory.correspondences.empty());
  const ResidualEvaluation after = problem.Predict(problem.Start(), false, kWhole, &memory);
  ASSERT_TRUE(after.usable) << after.message;
  EXPECT_EQ(after.residual, problem.Predict(problem.Start(), false).residual);
}

// On two cores, with an effect that both recordings share and that remembers.
TEST(CalibrationProblem, PredictsRecordingsSideBySideAsOneAfterTheOther) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  HeldBarTruth other_hold;
  other_hold.hold_force = {0, -0.03, 0.04};
  WriteBarRecording(folder / "other", FilmHeldBar(other_hold));
  std::map<std::string, std::string> changes = WithOtherRecording("");
  changes["  - {type: mass_damping, alpha: 1 1/s}\n"] =
      "  - {type: mass_damping, alpha: 1 1/s}\n"
      "  - {type: viscoelastic_branch, modulus: 20 kPa, relaxation_time: 20 ms}\n";
  changes["{name: mass_damping.alpha}"] =
      "{name: viscoelastic_branch.modulus}, {name: viscoelastic_branch.relaxation_time}";
  const PredictionStudy study = ReadBarStudy(folder.Path(), changes);
  const int threads = ThreadCount();
  ResidualEvaluation prediction[2];
  LinearisedMisfit linearised[2];
  std::vector<RecordingMisfit> misfits[2];
  for (int k = 0; k < 2; ++k) {
    SetThreadCount(k + 1);
    // A study of its own: an equilibrium is sought from the last one that was found.
    const CalibrationProblem own(study, BarMesh({6, 2, 2}, 1));
    prediction[k] = own.Predict(own.Start(), true);
    linearised[k] = own.Linearise(own.Start(), {.with_jacobian = true});
    std::atomic<int64_t> frames = 0;
    misfits[k] = MisfitsOf(own, own.Start(), /*known=*/nullptr, [&] { ++frames; });
    EXPECT_EQ(frames, own.LinearisedFrames()) << "both recordings are fitted";
    EXPECT_EQ(frames, 2 * kFrames);
    ASSERT_TRUE(prediction[k].usable) << prediction[k].message;
    ASSERT_TRUE(linearised[k].usable) << linearised[k].message;
    ASSERT_EQ(misfits[k].size(), 2u);
  }
  SetThreadCount(threads);
  EXPECT_EQ(prediction[0].residual, prediction[1].residual);
  EXPECT_EQ(prediction[0].jacobian, prediction[1].jacobian);
  EXPECT_EQ(linearised[0].residual, linearised[1].residual);
  EXPECT_EQ(linearised[0].jacobian, linearised[1].jacobian);
  for (size_t r = 0; r < 2; ++r) EXPECT_EQ(misfits[0][r].in_fit.rms, misfits[1][r].in_fit.rms);
}

}  // namespace
}  // namespace lacuna
