#include "fem/element_strain.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "support/box_mesh.h"

namespace lacuna {
namespace {

TEST(ElementStrain, IsExactForAHomogeneousDeformationAndInvariantUnderRotation) {
  for (const int order : {1, 2}) {
    const Body body = MakeBody(BoxMesh({0, 0, 0}, {2, 1, 1}, {2, 1, 1}, order), 1000);
    const Eigen::Matrix3d rotation =
        Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    const Eigen::Vector3d stretch(1.2, 0.9, 1);
    const Eigen::Vector3d rate(0.5, 0, -0.7);  // of the stretches, 1/s
    const Eigen::Matrix3Xd stretched = stretch.asDiagonal() * body.mesh.nodes;
    const Eigen::Matrix3Xd moving = rate.asDiagonal() * body.mesh.nodes;
    const Eigen::VectorXd position = (rotation * stretched).reshaped();
    const Eigen::VectorXd velocity = (rotation * moving).reshaped();
    const ElementStrain strain = MeanStrain(body, 3, position, velocity);
    // The tolerances cover rounding errors.
    EXPECT_NEAR(LargestPrincipal(strain.strain), 0.5 * (1.44 - 1), 1e-12);
    EXPECT_NEAR(strain.strain[1], 0.5 * (0.81 - 1), 1e-12);
    EXPECT_NEAR(LargestPrincipal(strain.rate), 0.7, 1e-12);  // λ dλ/dt of the third stretch
    EXPECT_NEAR(strain.rate[0], 1.2 * 0.5, 1e-12);
  }
}

}  // namespace
}  // namespace lacuna
