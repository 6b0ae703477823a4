// The finite differences by the object's dimensions, which leave its grips what they hold.
#include "calibration/size_errors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>

#include "calibration/known_errors.h"
#include "support/held_bar.h"
#include "support/replace_in_file.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"
#include "support/test_effect.h"

namespace lacuna {
namespace {

const char* const kClampBeyond = "half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}";
const char* const kHoldBeyond = "{half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}";

TetMesh CoarseBar() { return BarMesh({3, 1, 1}, 1); }

struct SizeChanges {
  LinearisedMisfit misfit;
  Eigen::MatrixXd changes;
};

SizeChanges ChangesOf(const PredictionStudy& study) {
  const CalibrationProblem problem(study, CoarseBar());
  const LinearisedMisfit misfit = problem.Linearise(problem.Start());
  EXPECT_TRUE(misfit.usable) << misfit.message;
  return {misfit, ChangesBySize(problem, problem.Start(), misfit)};
}

class SizeErrorsOfABar : public testing::Test {
 protected:
  SizeErrorsOfABar() { WriteBarRecording(folder_.Path(), FilmHeldBar({})); }
  TemporaryFolder folder_;
};

// A box that ends at the faces of the object, of which a larger object would stick out.
TEST_F(SizeErrorsOfABar, DoNotDependOnHowAClampIsDescribed) {
  const SizeChanges beyond = ChangesOf(ReadBarStudy(folder_.Path()));
  ASSERT_EQ(beyond.changes.cols(), 3);
  for (int axis = 0; axis < 3; ++axis) EXPECT_GT(beyond.changes.col(axis).norm(), 0) << axis;

  ReplaceInFile(folder_ / "recording.yaml", kClampBeyond,
                "box: {min: [0 m, -0.01 m, -0.01 m], max: [0.002 m, 0.01 m, 0.01 m]}");
  // The hand holds the far face alone, which a longer object moves out of the box.
  const SizeChanges boxes =
      ChangesOf(ReadBarStudy(folder_.Path(), {{kHoldBeyond,
                                               "{box: {min: [0.079 m, -0.01 m, -0.01 m], max: "
                                               "[0.08 m, 0.01 m, 0.01 m]}}"}}));
  ASSERT_EQ(boxes.misfit.residual, beyond.misfit.residual) << "the same nodes";
  ASSERT_EQ(boxes.changes.cols(), 3);
  EXPECT_LT((boxes.changes - beyond.changes).norm(), 1e-9 * beyond.changes.norm());
}

// In the second recording the bar is clamped at its other end, which stays where it is there.
TEST_F(SizeErrorsOfABar, AreThoseOfEachRecordingsOwnClamp) {
  const std::string near_end = "{half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}}";
  WriteBarRecording(folder_ / "other", FilmHeldBar({}));
  ReplaceInFile(folder_ / "other" / "recording.yaml", kClampBeyond,
                "half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}");
  const SizeChanges alone = ChangesOf(ReadBarStudy(folder_ / "other", {{kHoldBeyond, near_end}}));
  const std::string release = "      release: 0.0437 s\n";
  const SizeChanges both = ChangesOf(ReadBarStudy(
      folder_.Path(),
      {{release, release +
                     "  - recording: other/recording.yaml\n    name: other\n    fit_until: "
                     "0.1501 s\n    clock_deviation: 10 ms\n    hold:\n      region: " +
                     near_end + "\n" + release}}));
  ASSERT_EQ(alone.changes.cols(), 3);
  ASSERT_EQ(both.changes.cols(), 3);
  const LinearisedMisfit::Part& second = both.misfit.PointsOf(1);
  ASSERT_EQ(second.layout.Rows(), alone.changes.rows());
  const Eigen::MatrixXd own = both.changes.middleRows(second.first_row, second.layout.Rows());
  EXPECT_LT((own - alone.changes).norm(), 1e-9 * alone.changes.norm());
}

TEST_F(SizeErrorsOfABar, AreNoneWithoutAnUncertainty) {
  const SizeChanges exact = ChangesOf(
      ReadBarStudy(folder_.Path(), {{"noise: 0.05 mm\n", "noise: 0.05 mm\nsize_deviation: 0\n"}}));
  EXPECT_EQ(exact.changes.cols(), 0);
  EXPECT_EQ(exact.changes.rows(), exact.misfit.residual.size());
}

// Stands for whatever cannot be simulated with a longer object.
class FailureOfLongBars final : public TestEffect<FailureOfLongBars> {
 public:
  static constexpr const char* kType = "failure_of_long_bars";
  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    constexpr double kLength = 0.08, kRounding = 1e-9;  // m
    if (at.body.mesh.nodes.row(0).maxCoeff() > kLength + kRounding)
      force->setConstant(std::numeric_limits<double>::quiet_NaN());
  }
};

TEST_F(SizeErrorsOfABar, AreSaidToBeMissingWhereTheyCannotBeComputed) {
  PredictionStudy study = ReadBarStudy(folder_.Path());
  const auto notes = [&] {
    const CalibrationProblem problem(study, CoarseBar());
    SilentProgress progress;
    return FindKnownErrors(problem, problem.Start(), &progress).notes;
  };
  using testing::Contains, testing::HasSubstr, testing::Not;
  const char* const of_sizes = "do not contain the uncertainty of the object's dimensions";
  const char* const of_mesh = "do not contain the error of the mesh";
  EXPECT_THAT(notes(), Not(Contains(HasSubstr(of_sizes))));
  // A sheet has no other mesh.
  study.recordings.front().recording.reference.sheet_thickness = 1e-3;
  EXPECT_THAT(notes(), Contains(HasSubstr(of_mesh)));
  study.effects.push_back(std::make_shared<const FailureOfLongBars>());
  EXPECT_EQ(ChangesOf(study).changes.cols(), 0);
  EXPECT_THAT(notes(), Contains(HasSubstr(of_sizes)));
}

}  // namespace
}  // namespace lacuna
