// A motion with a frame whose residual was not measured has no objective.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "paper/parameter_objective.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

TEST(UnmeasuredObjective, AFailedRegistrationIsAFailedEvaluation) {
  ReconstructionStudy study;
  study.frames = {0, 5, 10};
  const std::vector<FrameState> states(3);
  const TrackedFrames tracked{};
  const ParameterObjective problem{study, states, tracked, true, /*registration_in_loop=*/true, 0};
  FollowedMotion motion;
  motion.body =
      std::make_shared<Body>(MakeBody(BoxMesh({0, 0, 0}, {0.08, 0.02, 0.02}, {4, 1, 1}), 1000));
  motion.frames.resize(3);
  for (FollowedFrame& frame : motion.frames) {
    frame.solver.usable = true;
    frame.position = motion.body->mesh.nodes;
    frame.residual = Eigen::Matrix3Xd::Zero(3, motion.body->boundary.node.size());
  }
  motion.frames[1].residual.setConstant(kNotMeasured);
  motion.frames[1].residual_problem = "no overlap";
  const ObjectiveEvaluation evaluation = MeasureObjective(problem, motion);
  EXPECT_FALSE(evaluation.usable);
  EXPECT_EQ(evaluation.failure, "frame 5: registration: no overlap");
  EXPECT_TRUE(std::isnan(evaluation.residual_sum));
  EXPECT_TRUE(std::isnan(evaluation.residual_per_point));
}

}  // namespace
}  // namespace lacuna
