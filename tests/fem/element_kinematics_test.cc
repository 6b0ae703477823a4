#include "fem/element_kinematics.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/box_mesh.h"

namespace lacuna {
namespace {

Body BodyOfOrder(int order) {
  const TetMesh mesh = Jittered(BoxMesh({0.1, 0, 0}, {0.2, 0.05, 0.04}, {3, 2, 2}), 0.03, 0.2, 1);
  return MakeBody(order == 1 ? mesh : ToQuadratic(mesh), 1000);
}

// Calls visit(element, gradients) for all elements.
template <typename Visit>
void ForEachGradient(const Body& body, const Eigen::VectorXd& field, const Visit& visit) {
  WithNodesPerElement(body, [&](auto nodes) {
    constexpr int kNodes = decltype(nodes)::value;
    for (int e = 0; e < body.ElementCount(); ++e) {
      Eigen::Matrix3d gradients[QuadraturePoints<kNodes>()];
      FieldGradients<kNodes>(body, e, field, gradients);
      visit(e, gradients);
    }
  });
}

class ElementKinematics : public testing::TestWithParam<int> {};

// Also far from the origin.
TEST_P(ElementKinematics, AnAffineFieldHasItsGradientEverywhere) {
  const Body body = BodyOfOrder(GetParam());
  const Eigen::Matrix3d F = Eigen::Matrix3d::Random();
  const Eigen::Matrix3Xd field = (F * body.mesh.nodes).colwise() + Eigen::Vector3d(1000, -500, 2);
  int points = 0;
  ForEachGradient(body, field.reshaped(), [&](int, const auto& gradients) {
    for (const Eigen::Matrix3d& found : gradients) {
      EXPECT_LT((found - F).norm(), 1e-9);
      ++points;
    }
  });
  EXPECT_EQ(points, body.PointCount());
}

// The gradient of x ↦ z² e_y is 2 z e_y ⊗ e_z.
TEST(QuadraticElements, AQuadraticFieldHasItsGradientAtTheirPoints) {
  const Body body = BodyOfOrder(2);
  Eigen::Matrix3Xd field = Eigen::Matrix3Xd::Zero(3, body.NodeCount());
  field.row(1) = body.mesh.nodes.row(2).array().square();
  ForEachGradient(body, field.reshaped(), [&](int e, const auto& gradients) {
    for (int p = 0; p < body.points_per_element; ++p) {
      Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
      expected(1, 2) = 2 * body.point(2, e * body.points_per_element + p);
      EXPECT_LT((gradients[p] - expected).norm(), 1e-12);
    }
  });
}

// The power of the nodal forces is that of the stresses: Σ_a f_a · v_a = −Σ_q w_q P_q : ∇v(q).
TEST_P(ElementKinematics, NodalForcesHaveThePowerOfTheStresses) {
  const Body body = BodyOfOrder(GetParam());
  const Eigen::VectorXd velocity = Eigen::VectorXd::Random(3 * body.NodeCount());
  Eigen::VectorXd force = Eigen::VectorXd::Zero(3 * body.NodeCount());
  double power = 0;
  WithNodesPerElement(body, [&](auto nodes) {
    constexpr int kNodes = decltype(nodes)::value;
    constexpr int kPoints = QuadraturePoints<kNodes>();
    for (int e = 0; e < body.ElementCount(); ++e) {
      Eigen::Matrix3d weighted[kPoints], rate[kPoints];
      FieldGradients<kNodes>(body, e, velocity, rate);
      for (int p = 0; p < kPoints; ++p) {
        weighted[p] = body.weight[e * kPoints + p] * Eigen::Matrix3d::Random();
        power -= weighted[p].cwiseProduct(rate[p]).sum();
      }
      AddPointForces<kNodes>(body, e, weighted, &force);
    }
  });
  EXPECT_NE(power, 0);
  EXPECT_NEAR(force.dot(velocity), power, 1e-12 * force.norm() * velocity.norm());
  EXPECT_LT(force.reshaped(3, body.NodeCount()).rowwise().sum().norm(), 1e-12 * force.norm());
}

INSTANTIATE_TEST_SUITE_P(Orders, ElementKinematics, testing::Values(1, 2));

}  // namespace
}  // namespace lacuna
