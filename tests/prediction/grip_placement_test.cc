#include "prediction/grip_placement.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "geometry/rotation.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

const Eigen::Matrix3Xd kRest = BoxMesh({0, 0, 0}, {0.04, 0.03, 0.02}, {2, 1, 1}).nodes;

// A grip of five nodes that turns about z and is carried along x.
Grip Carried() {
  Grip grip;
  grip.nodes = Eigen::VectorXi::LinSpaced(5, 1, 9);
  grip.motion =
      [held = Eigen::Matrix3Xd(kRest(Eigen::all, grip.nodes))](double time) -> Eigen::Matrix3Xd {
    return (RotationBy({0, 0, time}) * held).colwise() + Eigen::Vector3d(0.1 * time, 0, 0);
  };
  return grip;
}

// The displacement of all nodes, 3n.
Eigen::VectorXd OnNodes(const Grip& grip, const Eigen::Matrix3Xd& places) {
  Eigen::Matrix3Xd all = Eigen::Matrix3Xd::Zero(3, kRest.cols());
  for (Eigen::Index i = 0; i < grip.nodes.size(); ++i) all.col(grip.nodes[i]) = places.col(i);
  return all.reshaped();
}

TEST(GripPlacement, MovesTheGripRigidlyAboutItsMiddle) {
  const Grip grip = Carried();
  const GripPlacement placement{{1e-3, 2e-3, -3e-3}, {0.2, -0.1, 0.4}};
  const Eigen::Matrix3Xd before = grip.motion(0.7);
  const Eigen::Matrix3Xd after = PlacedGrip(grip, kRest, placement).motion(0.7);
  const Eigen::Vector3d moved = after.rowwise().mean() - before.rowwise().mean();
  EXPECT_LT((moved - placement.shift).norm(), 1e-15);  // rounding, as below
  const Eigen::Vector3d edge = before.col(3) - before.col(0);
  EXPECT_LT((after.col(3) - after.col(0) - RotationBy(placement.turn) * edge).norm(), 1e-15);
  // A clamp that does not move is placed at rest.
  Grip clamp = grip;
  clamp.motion = nullptr;
  const Eigen::Matrix3Xd held = kRest(Eigen::all, clamp.nodes);
  EXPECT_LT((PlacedGrip(clamp, kRest, {}).motion(3) - held).norm(), 1e-15);
}

TEST(GripPlacement, HasTheDerivativesOfItsMotion) {
  const Grip grip = Carried();
  constexpr double kStep = 1e-5;
  for (const double size : {0.0, 1e-3, 0.8}) {
    const GripPlacement at{{1e-3, 2e-3, -3e-3}, size * Eigen::Vector3d(0.5, -0.7, 0.9)};
    for (const bool turns : {false, true}) {
      for (int axis = 0; axis < 3; ++axis) {
        GripPlacement plus = at, minus = at;
        (turns ? plus.turn : plus.shift)[axis] += kStep;
        (turns ? minus.turn : minus.shift)[axis] -= kStep;
        const Eigen::VectorXd difference =
            OnNodes(grip, PlacedGrip(grip, kRest, plus).motion(0.7) -
                              PlacedGrip(grip, kRest, minus).motion(0.7)) /
            (2 * kStep);
        const Eigen::VectorXd derivative =
            PlacementDerivative(grip, kRest, at, turns, axis)(0.7, {});
        EXPECT_GT(derivative.norm(), 1e-3);
        // Truncation is of the order of the square of the step, rounding of 1e-17 m over the step.
        EXPECT_LT((derivative - difference).norm(), 1e-8 * derivative.norm())
            << size << " " << turns << " " << axis;
      }
    }
  }
}

TEST(GripPlacement, LeavesTheDirectionsFreeAlongWhichTheGripDoesNotHold) {
  Grip grip = Carried();
  grip.axes = AxisSet::Of(2);
  const Eigen::VectorXd along = PlacementDerivative(grip, kRest, {}, false, 2)(0, {});
  EXPECT_EQ(along.sum(), 5);
  EXPECT_EQ(PlacementDerivative(grip, kRest, {}, false, 0)(0, {}).norm(), 0);
}

}  // namespace
}  // namespace lacuna
