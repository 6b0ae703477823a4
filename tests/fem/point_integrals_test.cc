#include "fem/point_integrals.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/box_mesh.h"
#include "support/dense_matrix.h"

namespace lacuna {
namespace {

class PointIntegrals : public testing::TestWithParam<int> {};

// The blocks −1.5 Σ_q w_q (g_a)_j (g_b)_l F₂₂ C_ijkl, summed point by point, with a skew-symmetric
// C and a deformation gradient F that differs from point to point.
TEST_P(PointIntegrals, SumTheBlocksOfASkewTangent) {
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.2, 0.1, 0.1}, {4, 2, 2}, GetParam()), 1000);
  ASSERT_GT(body.ElementCount(), ElementSchedule::kElementsPerBatch);
  Eigen::Matrix3Xd deformed = body.mesh.nodes;
  deformed.row(2).array() *= 1 + 5 * deformed.row(0).array() + 3 * deformed.row(1).array();
  const Eigen::VectorXd position = deformed.reshaped();
  const Eigen::VectorXd none;
  StressTangent any;
  for (int k = 0; k < 81; ++k) any(k % 9, k / 9) = (7 * k * k + 3 * k) % 23;
  const StressTangent C = any - any.transpose();
  BlockMatrix tangent(body.pattern);
  AddStiffnessMatrix<DeformationGradients, -1>(
      {body, position, none, none, 0, 0, none}, 1.5,
      [&](const auto& points, int k) { return StressTangent(points.gradient[k](2, 2) * C); },
      &tangent);

  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(position.size(), position.size());
  const Eigen::Index nodes = body.mesh.tets.rows();
  for (int q = 0; q < body.PointCount(); ++q) {
    const auto node = body.mesh.tets.col(q / body.points_per_element);
    const auto gradient = body.shape_gradient.middleCols<3>(3 * q);  // nodes × 3
    double F22 = 0;
    for (Eigen::Index a = 0; a < nodes; ++a) F22 += deformed(2, node[a]) * gradient(a, 2);
    for (Eigen::Index a = 0; a < nodes; ++a)
      for (Eigen::Index b = 0; b < nodes; ++b)
        for (int j = 0; j < 3; ++j)
          for (int l = 0; l < 3; ++l)
            expected.block<3, 3>(3 * node[a], 3 * node[b]) -= 1.5 * body.weight[q] *
                                                              gradient(a, j) * gradient(b, l) *
                                                              F22 * C.block<3, 3>(3 * j, 3 * l);
  }
  const Eigen::MatrixXd dense = Dense(tangent);
  ASSERT_GT(expected.norm(), 0);
  EXPECT_LT((dense - expected).norm(), 1e-12 * expected.norm());
  EXPECT_LT((dense + dense.transpose()).norm(), 1e-12 * dense.norm());
}

INSTANTIATE_TEST_SUITE_P(LinearAndQuadratic, PointIntegrals, testing::Values(1, 2));

}  // namespace
}  // namespace lacuna
