// A registration that fails is not one that agrees.
#include "reconstruction/tracked_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "effects/catalogue.h"
#include "reconstruction/body_registration.h"
#include "reconstruction/follow.h"
#include "support/box_mesh.h"
#include "support/silent_progress.h"

namespace lacuna {
namespace {

using testing::Contains;
using testing::HasSubstr;

// A clamped bar in three frames. Of the second only four points were scanned; in the third the
// surface has moved by 1 mm.
class FailedRegistration : public testing::Test {
 protected:
  FailedRegistration() {
    reference_.mesh = BoxMesh({0, -0.01, -0.01}, {0.08, 0.01, 0.01}, {8, 2, 2});
    study_.name = "bar";
    study_.frames = {0, 5, 10};
    study_.recording.times = {0, 1, 2};
    study_.recording.object.fixed = {{{"clamp", HalfSpaceRegion{{0.002, 0, 0}, {-1, 0, 0}}}}};
    study_.effects = {MakeEffect("linear", {{"young_modulus", 1e5}, {"poisson_ratio", 0.3}})};
    study_.follow.scheme = TimeScheme::kQuasiStatic;
    study_.follow.forces.kind = ForceSettings::Kind::kNone;
    study_.follow.noise = 1e-4;
    states_.resize(3);
    states_[0].surface = ExtractBoundary(reference_.mesh).surface;
    states_[0].cloud = {states_[0].surface.vertices, VertexNormals(states_[0].surface)};
    states_[1].time = 1;
    states_[1].cloud = {states_[0].cloud.points.leftCols(4), states_[0].cloud.normals.leftCols(4)};
    states_[2] = states_[0];
    states_[2].time = 2;
    states_[2].surface.vertices.row(1).array() += 1e-3;
    states_[2].cloud.points.row(1).array() += 1e-3;
  }

  ReconstructionStudy study_;
  ReferenceBody reference_;
  std::vector<FrameState> states_;
  SilentProgress progress_;
};

TEST_F(FailedRegistration, HasAnInfiniteDeviationAndItsReason) {
  const TrackedFrames tracked = TrackFrames(study_, states_, &progress_);
  const Eigen::Matrix3Xd& points = tracked.points;
  EXPECT_TRUE((tracked.DeviationAt(0, points).array() == 0).all());
  EXPECT_TRUE(
      (tracked.DeviationAt(1, points).array() == std::numeric_limits<double>::infinity()).all());
  EXPECT_TRUE(tracked.DeviationAt(2, points).allFinite());
  EXPECT_THAT(tracked.failures.at(1), HasSubstr("too few points"));
  EXPECT_EQ(tracked.failures.at(2), "");
  EXPECT_THAT(tracked.warnings, Contains(HasSubstr("frame 5: registration: too few points")));
  // The next frame is registered as if this one were not there. The smooth field of so few points
  // follows the shift to some tenths.
  EXPECT_NEAR(tracked.DisplacementAt(2, points).row(1).mean(), 1e-3, 4e-4);
}

TEST_F(FailedRegistration, StartsTheFrameWhereTheLastOneEnded) {
  std::swap(states_[1], states_[2]);
  const TrackedFrames tracked = TrackFrames(study_, states_, &progress_);
  EXPECT_NE(tracked.failures.at(2), "");
  EXPECT_EQ(tracked.DisplacementAt(2, tracked.points), tracked.DisplacementAt(1, tracked.points));
}

// A displacement of CPD has its error along two axes of the surface, so that the deviation along
// one is less than that of the whole.
TEST_F(FailedRegistration, TheDeviationOfATargetIsThatAlongOneAxisOfTheSurface) {
  const TrackedFrames tracked = TrackFrames(study_, states_, &progress_);
  const Body body = MakeBody(reference_.mesh, 1000);
  std::vector<std::string> warnings;
  const BodyRegistration registration(study_, body, states_, &tracked, &warnings);
  const Eigen::VectorXd whole = tracked.DeviationAt(2, body.boundary.surface.vertices);
  const Eigen::VectorXd along = registration.Register(2, body.mesh.nodes).sigma;
  EXPECT_TRUE((2 * along.array().square()).isApprox(whole.array().square()));
}

void ExpectUnmeasuredInTheSecond(const FollowedMotion& motion) {
  ASSERT_EQ(motion.frames.size(), 3u);
  for (const FollowedFrame& frame : motion.frames)
    EXPECT_TRUE(frame.solver.usable) << frame.solver.message;
  EXPECT_EQ(motion.frames[0].residual_problem, "");
  EXPECT_THAT(motion.frames[1].residual_problem, HasSubstr("too few points"));
  EXPECT_TRUE(motion.frames[1].residual.array().isNaN().all());
  EXPECT_EQ(motion.frames[2].residual_problem, "");
  // Nothing moves the model, so that D is the motion of the surface.
  EXPECT_NEAR(motion.frames[2].residual.row(1).mean(), 1e-3, 4e-4);
  EXPECT_THAT(motion.warnings, Contains(HasSubstr("frame 5: registration: too few points")));
}

TEST_F(FailedRegistration, LeavesTheResidualUnmeasured) {
  const TrackedFrames tracked = TrackFrames(study_, states_, &progress_);
  ExpectUnmeasuredInTheSecond(FollowFrames(study_, reference_, states_, &progress_, &tracked));
}

TEST_F(FailedRegistration, InTheLoopLeavesTheResidualUnmeasured) {
  ExpectUnmeasuredInTheSecond(FollowFrames(study_, reference_, states_, &progress_));
}

}  // namespace
}  // namespace lacuna
