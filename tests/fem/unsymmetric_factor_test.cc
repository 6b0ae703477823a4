#include "fem/unsymmetric_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <memory>
#include <random>
#include <vector>

#include "support/box_mesh.h"
#include "support/dense_matrix.h"

namespace lacuna {
namespace {

// A matrix that is neither symmetric nor definite, with one node held and one held along y.
TEST(UnsymmetricFactor, SolvesForTheFreeComponents) {
  const TetMesh mesh = BoxMesh({0, 0, 0}, {2, 1, 1}, {2, 1, 1});
  const auto pattern =
      std::make_shared<const BlockPattern>(MakeBlockPattern(mesh.NodeCount(), mesh.tets));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  BlockMatrix symmetric(pattern), skew(pattern);
  for (int row = 0; row < pattern->nodes; ++row)
    for (int k = pattern->row_begin[row]; k < pattern->row_begin[row + 1]; ++k) {
      const int column = pattern->column[k];
      if (column < row) continue;
      const int mirrored = pattern->Find(column, row);
      const Eigen::Matrix3d a = Eigen::Matrix3d::NullaryExpr([&] { return uniform(random); });
      const Eigen::Matrix3d b = Eigen::Matrix3d::NullaryExpr([&] { return uniform(random); });
      symmetric.Block(k) = column == row ? Eigen::Matrix3d(a + a.transpose()) : a;
      symmetric.Block(mirrored) = Eigen::Matrix3d(symmetric.Block(k).transpose());
      skew.Block(k) = column == row ? Eigen::Matrix3d(b - b.transpose()) : b;
      skew.Block(mirrored) = Eigen::Matrix3d(-skew.Block(k).transpose());
    }
  std::vector<AxisSet> axes(static_cast<size_t>(pattern->nodes), AxisSet());
  axes[2] = AxisSet::All();
  axes[5] = AxisSet::Of(1);
  const HeldComponents held(axes);
  std::vector<int> free;
  for (int i = 0; i < 3 * pattern->nodes; ++i)
    if (!axes[static_cast<size_t>(i / 3)].Has(i % 3)) free.push_back(i);
  const Eigen::MatrixXd right =
      Eigen::MatrixXd::NullaryExpr(3 * pattern->nodes, 2, [&] { return uniform(random); });

  const Eigen::MatrixXd whole = Dense(symmetric) + Dense(skew);
  for (const bool has_skew : {true, false}) {
    const UnsymmetricFactor factor(held, symmetric, has_skew ? &skew : nullptr);
    ASSERT_TRUE(factor.IsUsable());
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(right.rows(), right.cols());
    const Eigen::MatrixXd matrix = (has_skew ? whole : Dense(symmetric))(free, free);
    const Eigen::MatrixXd of_free = right(free, Eigen::all);
    const Eigen::MatrixXd solution = matrix.partialPivLu().solve(of_free);
    expected(free, Eigen::all) = solution;
    EXPECT_LT((factor.Solve(right) - expected).norm(), 1e-9 * expected.norm());
  }

  symmetric.SetZero();
  EXPECT_FALSE(UnsymmetricFactor(held, symmetric, nullptr).IsUsable());
}

}  // namespace
}  // namespace lacuna
