#include "fem/deformation_rates.h"

#include <gtest/gtest.h>

#include "support/box_mesh.h"

namespace lacuna {
namespace {

const Eigen::Matrix3d kDeformation{{1.2, 0.1, 0}, {-0.2, 0.9, 0.1}, {0.1, 0, 1.1}};
const Eigen::Matrix3d kRate{{0.5, 0, -2}, {1, 3, 0}, {0, -0.7, 4}};  // 1/s

class DeformationRatesTest : public testing::TestWithParam<int> {};

// All points of the body have the deformation gradient and the rate above; the batch begins within
// the mesh.
TEST_P(DeformationRatesTest, AreThoseAtEachPointOfABatch) {
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.2, 0.1, 0.1}, {4, 2, 2}, GetParam()), 1000);
  const Eigen::VectorXd position = (kDeformation * body.mesh.nodes).reshaped();
  const Eigen::VectorXd velocity = (kRate * body.mesh.nodes).reshaped();
  const Eigen::VectorXd none;
  const Kinematics at{body, position, velocity, none, 0, 0, none};
  WithNodesPerElement(body, [&](auto nodes) {
    const DeformationRates<decltype(nodes)::value> points(at, 3, 7);
    for (int k = 0; k < 4 * body.points_per_element; ++k) {
      EXPECT_LT((points.F(k) - kDeformation).norm(), 1e-13);
      EXPECT_LT((points.Rate(k) - kRate).norm(), 1e-13);
    }
  });
}

INSTANTIATE_TEST_SUITE_P(LinearAndQuadratic, DeformationRatesTest, testing::Values(1, 2));

}  // namespace
}  // namespace lacuna
