// The columns of an unknown smooth force explain a force that was hidden in a recording.
#include "diagnosis/unknown_force.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

#include "calibration/calibration_problem.h"
#include "calibration/linear_misfit.h"
#include "comparison/coarse_bar.h"
#include "support/held_bar.h"
#include "support/scanned_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

enum class SeenBy { kMarkers, kScans };

class HiddenForce : public testing::TestWithParam<SeenBy> {
 protected:
  // Records the bar while a body force acts that the model lacks.
  void Record() const {
    HeldBarTruth truth;
    truth.body_force = [](double time) {
      return Eigen::Vector3d(0, 0.04 * std::sin(20 * time), 0);  // N
    };
    if (GetParam() == SeenBy::kMarkers)
      WriteBarRecording(folder_.Path(), FilmHeldBar(truth));
    else
      WriteBarScans(folder_.Path(), HeldBarSurfaces(truth),
                    "fixed: [{name: clamp, half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, "
                    "0, 0]}}]\nreference: {from: mesh, file: box.off}\n");
  }

  const TemporaryFolder folder_;
};

TEST_P(HiddenForce, IsExplainedByTheColumns) {
  Record();
  // The model's mesh and time step are coarser than those of the recorded motion.
  const PredictionStudy study = ReadCoarseBarStudy(folder_.Path());
  const CalibrationProblem problem(study, BarMesh({6, 2, 2}, 2));
  Eigen::VectorXd values = problem.Start();
  const HeldBarTruth truth;
  for (size_t k = 0; k < problem.parameters().size(); ++k)
    for (int axis = 0; axis < 3; ++axis)
      if (problem.parameters()[k].name == std::string("bar.hold_force_") + "xyz"[axis])
        values[static_cast<Eigen::Index>(k)] = truth.hold_force[axis];
  const LinearisedMisfit misfit = problem.Linearise(values, {.with_jacobian = true});
  ASSERT_TRUE(misfit.usable) << misfit.message;
  const UnknownForce unknown = UnknownForceColumns(problem, values, misfit);
  EXPECT_TRUE(unknown.untried.empty());
  const Eigen::MatrixXd& columns = unknown.columns;
  ASSERT_EQ(columns.rows(), misfit.residual.size());
  ASSERT_GT(columns.cols(), 10);
  ASSERT_LE(columns.cols(), 40);
  ASSERT_TRUE(columns.allFinite());
  // Beside the parameters, which include the force of the hand before the release.
  const Eigen::MatrixXd known = WhitenedRows(misfit.jacobian, misfit);
  Eigen::MatrixXd all(known.rows(), known.cols() + columns.cols());
  all << known, WhitenedRows(columns, misfit);
  const Eigen::VectorXd residual = WhitenedRows(misfit.residual, misfit);
  const auto left = [&](const Eigen::MatrixXd& by) {
    return (residual - by * by.colPivHouseholderQr().solve(residual)).squaredNorm() /
           static_cast<double>(residual.size());
  };
  EXPECT_GT(left(known), 4);
  EXPECT_LT(left(all), 1.5);
}

INSTANTIATE_TEST_SUITE_P(Seen, HiddenForce, testing::Values(SeenBy::kMarkers, SeenBy::kScans));

// Three frames after the release do not tell how a force changes with time.
TEST(UnknownForceColumns, SayWhichRecordingIsTooShort) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  PredictionStudy study = ReadCoarseBarStudy(folder.Path());
  study.recordings.front().frames.resize(8);
  const CalibrationProblem problem(study, BarMesh({3, 1, 1}, 1));
  const Eigen::VectorXd values = problem.Start();
  const LinearisedMisfit misfit = problem.Linearise(values);
  ASSERT_TRUE(misfit.usable) << misfit.message;
  const UnknownForce unknown = UnknownForceColumns(problem, values, misfit);
  EXPECT_EQ(unknown.columns.rows(), misfit.residual.size());
  EXPECT_EQ(unknown.columns.cols(), 0);
  EXPECT_THAT(unknown.untried,
              testing::ElementsAre("bar: there are too few frames after the start of the motion"));
}

}  // namespace
}  // namespace lacuna
