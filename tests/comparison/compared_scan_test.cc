// The comparison of a model with scans, for which it is run again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "comparison/coarse_bar.h"
#include "comparison/compared_motion.h"
#include "comparison/comparison_files.h"
#include "comparison/force_estimate.h"
#include "comparison/run_comparison.h"
#include "prediction/replayed_motion.h"
#include "record/motion_record.h"
#include "report/comparison_report.h"
#include "support/scanned_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::Contains;
using testing::HasSubstr;

// Films the bar with depth cameras.
void ScanHeldBar(const HeldBarTruth& truth, const std::filesystem::path& folder) {
  WriteBarScans(folder, HeldBarSurfaces(truth),
                "fixed: [{name: clamp, half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, "
                "0]}}]\nreference: {from: mesh, file: box.off}\n");
}

TEST(ComparedScan, AddsTrendsFieldsAndTheForce) {
  const TemporaryFolder folder;
  HeldBarTruth truth;
  truth.alpha = 8;  // 1/s; the model has 1
  ScanHeldBar(truth, folder.Path());
  ASSERT_TRUE(RunBarWithLittleDamping(folder.Path(), "3 ms"));
  const std::filesystem::path run = folder / "run";
  const Comparison comparison = CompareWithMotion(run);
  EXPECT_THAT(comparison.record.notes, testing::IsEmpty());
  const ComparedRecording& bar = comparison.record.recordings.at(0);
  EXPECT_TRUE(bar.is_scan);
  EXPECT_TRUE(bar.height_by_gravity);
  ASSERT_EQ(bar.parts.size(), 2u);  // fitted and held-out frames
  ExpectTrendsOfTheMotion(bar);
  ASSERT_TRUE(bar.loaded_most);
  EXPECT_LT(bar.loaded_most->stretch_place.x(), 0.04);  // near the clamp rather than the free end
  ASSERT_TRUE(bar.force);
  EXPECT_TRUE(bar.force->usable) << bar.force->message;
  EXPECT_LT(bar.force->work.work, 0);  // the damping that the model lacks removes energy
  EXPECT_LT(bar.force->fit.rms_over_sigma_with, bar.force->fit.rms_over_sigma_without);
  EXPECT_THAT(DescribeComparison(comparison.record), Contains(HasSubstr("bar, unexplained force")));

  WriteComparison(comparison, run);
  EXPECT_TRUE(std::filesystem::exists(run / "comparison/unexplained_force.csv"));
  // 13 of the 16 frames lie after the release; the last one before it shows the bar at rest.
  EXPECT_EQ(bar.field_frames, 14);
  for (const char* file :
       {"body.pvd", "patches.pvd", "fields/body_00002.vtu", "fields/patches_00015.vtp"})
    EXPECT_TRUE(std::filesystem::exists(run / "comparison/0" / file)) << file;
  EXPECT_FALSE(std::filesystem::exists(run / "comparison/0/markers.pvd"));
  const std::string patches = FileContent(run / "comparison/0/fields/patches_00015.vtp");
  EXPECT_THAT(patches, HasSubstr("\"along_normal_m\""));
  EXPECT_THAT(patches, HasSubstr("\"patch\""));

  ExpectForceInMotion(ReadMotionFile(MotionFile(run, 0)), comparison.record.fit);

  // Residuals of another model: in one frame, all patches lie farther out by the noise of one
  // point.
  Comparison other = CompareRun(run);
  other.residuals.at(0).along_normal.col(5).array() += kScanNoise;
  SilentProgress progress;
  CompareMotion(run, &progress, &other);
  EXPECT_THAT(other.record.notes, Contains(HasSubstr("no longer predicts bar")));
  EXPECT_FALSE(other.record.recordings.at(0).force);
}

// The unexplained force for scans of a bar. The model has the stiffness, the damping and the hold
// of the truth; its mesh and its time steps are coarser.
UnexplainedForce ForceOnScans(const HeldBarTruth& truth) {
  const TemporaryFolder folder;
  ScanHeldBar(truth, folder.Path());
  const PredictionStudy study = ReadCoarseBarStudy(folder.Path());
  const CalibrationProblem problem(study, BarMesh({6, 2, 2}, 2));
  const RecordingModel& model = problem.models()[0];
  Eigen::VectorXd nuisance =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.nuisances().size()));
  for (size_t k = 0; k < model.nuisances().size(); ++k)
    for (int axis = 0; axis < 3; ++axis)
      if (model.nuisances()[k].prior.name == std::string("bar.hold_force_") + "xyz"[axis])
        nuisance[static_cast<Eigen::Index>(k)] = truth.hold_force[axis];
  EXPECT_EQ((nuisance.array() != 0).count(), 2);
  const ReplayedMotion motion = Replay(model, nuisance);
  EXPECT_TRUE(motion.summary.IsUsable()) << motion.summary.message;
  return EstimateUnexplainedForce(model, motion, problem.ErrorsOf(model));
}

TEST(ComparedScan, FindsAHiddenBodyForce) {
  constexpr double kAmplitude = 0.04;  // N, an eighth of the bar's weight
  HeldBarTruth truth;
  truth.body_force = [](double time) {
    return Eigen::Vector3d(0, kAmplitude * std::sin(20 * time), 0);
  };
  const UnexplainedForce found = ForceOnScans(truth);
  const UnexplainedForceRecord& force = found.record;
  ASSERT_TRUE(force.usable) << force.message;
  EXPECT_TRUE(force.fit.converged);
  EXPECT_TRUE(force.fit.is_significant);
  EXPECT_GT(force.fit.rms_over_sigma_without, 5);
  EXPECT_LT(force.fit.rms_over_sigma_with, 1.7);
  // Within a third of the amplitude, rms over time, as for markers (force_estimate_test): the last
  // frames hardly show the force at the end, and the mesh is coarser than that of the truth.
  EXPECT_LT(NetForceError(found.history, truth, 1), 0.33 * kAmplitude);
  EXPECT_LT(NetForceError(found.history, truth, 2), 0.33 * kAmplitude);
  EXPECT_LT(force.net.rms_deviation.y(), 0.35 * kAmplitude);
}

TEST(ComparedScan, FindsHardlyAnyForceIfTheModelIsComplete) {
  const UnexplainedForceRecord force = ForceOnScans({}).record;
  ASSERT_TRUE(force.usable) << force.message;
  EXPECT_LT(force.fit.rms_over_sigma_without, 2);
  // The error of the coarse mesh is less than a twentieth of the weight. Along the bar, patches
  // show no force.
  EXPECT_LT(force.net.rms.tail<2>().norm(), 0.05 * force.net.weight);
}

}  // namespace
}  // namespace lacuna
