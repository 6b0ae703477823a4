#include "geometry/rigid_fit.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "geometry/rotation.h"

namespace lacuna {
namespace {

Eigen::Isometry3d Turned() {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.translate(Eigen::Vector3d(0.1, -0.2, 0.3));
  motion.rotate(RotationBy({0.3, -0.5, 0.2}));
  return motion;
}

double Difference(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.matrix() - b.matrix()).norm();
}

TEST(RigidFit, FindsTheMotionOfPointsOnAPlane) {
  Eigen::Matrix3Xd points(3, 4);
  points << 0, 1, 0, 1, 0, 0, 1, 1, 2, 2, 2, 2;
  const RigidFit fit = FitRigidMotion(points, Turned() * points);
  EXPECT_EQ(fit.span, 2);
  EXPECT_LT(Difference(fit.motion, Turned()), 1e-12);
}

TEST(RigidFit, IsARotationWhereAReflectionWouldFitBetter) {
  Eigen::Matrix3Xd points(3, 4);
  points << 0, 1, 0, 1, 0, 0, 1, 1, 1e-3, -1e-3, -1e-3, 1e-3;
  Eigen::Matrix3Xd mirrored = points;
  mirrored.row(2) *= -1;
  const RigidFit fit = FitRigidMotion(points, mirrored);
  EXPECT_NEAR(fit.motion.linear().determinant(), 1, 1e-12);
  EXPECT_LT(Difference(fit.motion, Eigen::Isometry3d::Identity()), 0.01);
}

TEST(RigidFit, IgnoresPointsThatAreNotSeen) {
  Eigen::Matrix3Xd points(3, 4);
  points << 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 1;
  Eigen::Matrix3Xd seen = Turned() * points;
  seen(1, 2) = std::numeric_limits<double>::quiet_NaN();
  const RigidFit fit = FitRigidMotion(points, seen);
  EXPECT_EQ(fit.span, 2);
  EXPECT_LT(Difference(fit.motion, Turned()), 1e-12);
}

TEST(RigidFit, DoesNotRotateAboutALine) {
  Eigen::Matrix3Xd points(3, 3);
  points << 0, 1, 2, 0, 0, 0, 0, 0, 0;
  EXPECT_LT(Difference(FitRigidMotion(points, points).motion, Eigen::Isometry3d::Identity()),
            1e-12);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  const Eigen::Matrix3d quarter = RotationBy({0, 0, std::numbers::pi / 2});
  const RigidFit fit = FitRigidMotion(points, quarter * points);
  EXPECT_EQ(fit.span, 1);
  EXPECT_LT((fit.motion.linear() - quarter).norm(), 1e-12);
  EXPECT_LT((fit.motion * points - quarter * points).norm(), 1e-12);
  EXPECT_NEAR((fit.motion.linear() * up).z(), 0, 1e-12);
}

TEST(RigidFit, OnePointDeterminesATranslationAndNoneNothing) {
  const Eigen::Matrix3Xd point = Eigen::Vector3d(1, 2, 3);
  const RigidFit fit = FitRigidMotion(point, Turned() * point);
  EXPECT_EQ(fit.span, 0);
  EXPECT_LT((fit.motion.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-15);
  EXPECT_LT((fit.motion * point - Turned() * point).norm(), 1e-15);
  EXPECT_EQ(FitRigidMotion(Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xd(3, 0)).span, -1);
}

TEST(AffineFit, StretchesAlongTheAxesThatThePointsSpan) {
  Eigen::Matrix3Xd points(3, 4);
  points << 0, 1, 0, 1, 0, 0, 1, 1, 2, 2, 2, 2;
  Eigen::Affine3d stretched = Eigen::Affine3d::Identity();
  stretched.linear() << 1.3, 0.1, 0, 0.1, 0.9, 0, 0, 0, 1;
  const Eigen::Affine3d motion = Turned() * stretched;
  const Eigen::Matrix3Xd there = motion * points;
  const Eigen::Affine3d found = FitAffineMotion(points, there, FitRigidMotion(points, there));
  EXPECT_LT((found.matrix() - motion.matrix()).norm(), 1e-9);
}

TEST(AffineFit, StretchesALineAndMovesAPoint) {
  Eigen::Matrix3Xd points(3, 2);
  points << 0, 1, 0, 0, 0, 0;
  const Eigen::Matrix3Xd longer = 2 * points;
  Eigen::Matrix3d twice = Eigen::Vector3d(2, 1, 1).asDiagonal();
  EXPECT_LT(
      (FitAffineMotion(points, longer, FitRigidMotion(points, longer)).linear() - twice).norm(),
      1e-12);
  const Eigen::Matrix3Xd point = Eigen::Vector3d(1, 2, 3), moved = 2 * point;
  const Eigen::Affine3d found = FitAffineMotion(point, moved, FitRigidMotion(point, moved));
  EXPECT_LT((found.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-15);
  EXPECT_LT((found * point - moved).norm(), 1e-15);
}

}  // namespace
}  // namespace lacuna
