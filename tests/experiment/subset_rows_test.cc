#include "experiment/subset_rows.h"

#include <gtest/gtest.h>

#include "support/box_mesh.h"

namespace lacuna {
namespace {

constexpr double kEdge = 0.01;  // m

// A quadratic mesh, which represents quadratic motions exactly, of a plate of 80 × 40 × 10 mm.
TetMesh Plate() { return BoxMesh({0, 0, 0}, {0.08, 0.04, 0.01}, {8, 4, 2}, 2); }

// In the middle of the upper face, at its edge, at its corner, and inside.
Eigen::Matrix3Xd PlacesOnPlate() {
  Eigen::Matrix3Xd places(3, 4);
  places.col(0) << 0.041, 0.019, 0.01;
  places.col(1) << 0.041, 0.04, 0.01;
  places.col(2) << 0.08, 0.04, 0.01;
  places.col(3) << 0.041, 0.019, 0.005;
  return places;
}

template <typename Motion>
Eigen::Matrix3Xd Seen(const Instrument& instrument, const Motion& motion) {
  const TetMesh mesh = Plate();
  Eigen::VectorXd moved(3 * mesh.NodeCount());
  for (Eigen::Index i = 0; i < mesh.NodeCount(); ++i)
    moved.segment<3>(3 * i) = motion(Eigen::Vector3d(mesh.nodes.col(i)));
  const Eigen::VectorXd seen = SubsetRows(mesh, PlacesOnPlate(), instrument) * moved;
  return seen.reshaped(3, PlacesOnPlate().cols());
}

TEST(SubsetRows, SeeConstantGradientsAsTheyAre) {
  Eigen::Matrix3d gradient;
  gradient << 1.1, 0.2, -0.1, 0.05, 0.9, 0.3, -0.2, 0.1, 1.05;
  const auto affine = [&](const Eigen::Vector3d& at) -> Eigen::Vector3d {
    return gradient * at + Eigen::Vector3d(0.01, -0.02, 0.03);
  };
  for (const bool is_volume : {false, true}) {
    const Eigen::Matrix3Xd seen = Seen({kEdge, is_volume}, affine);
    // A place inside belongs to volume correlation.
    for (int k = 0; k < (is_volume ? 4 : 3); ++k)
      EXPECT_LT((seen.col(k) - affine(PlacesOnPlate().col(k))).norm(), 1e-12) << is_volume << k;
  }
}

TEST(SubsetRows, SmoothCurvature) {
  constexpr double kCurvature = 5;  // 1/m
  const auto bent = [](const Eigen::Vector3d& at) -> Eigen::Vector3d {
    return at + Eigen::Vector3d(0, 0, 0.5 * kCurvature * at.x() * at.x());
  };
  const Eigen::Matrix3Xd seen = Seen({kEdge, false}, bent), in_volume = Seen({kEdge, true}, bent);
  // The mean of x² over five parts of the edge L is 0.08 L², near L²/12.
  const double more = 0.5 * kCurvature * 0.08 * kEdge * kEdge;  // 20 µm
  EXPECT_NEAR(seen(2, 0) - bent(PlacesOnPlate().col(0)).z(), more, 1e-9);
  EXPECT_NEAR(seen(2, 1) - bent(PlacesOnPlate().col(1)).z(), more, 1e-9) << "half of the subset is seen";
  EXPECT_NEAR(in_volume(2, 3) - bent(PlacesOnPlate().col(3)).z(), more, 1e-9);
  // At the corner the parabola is seen from one side, and its affine fit lies below it.
  EXPECT_LT(seen(2, 2), bent(PlacesOnPlate().col(2)).z());
}

}  // namespace
}  // namespace lacuna
