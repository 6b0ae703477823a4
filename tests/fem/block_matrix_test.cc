#include "fem/block_matrix.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>
#include <set>

#include "core/parallel.h"

namespace lacuna {
namespace {

// A row of unit cubes, each divided into six tetrahedra.
Eigen::MatrixXi RowOfCubes(int cubes) {
  const int path[6][3] = {{1, 3, 7}, {1, 5, 7}, {2, 3, 7}, {2, 6, 7}, {4, 5, 7}, {4, 6, 7}};
  const auto node = [](int cube, int corner) { return 4 * (cube + (corner & 1)) + (corner >> 1); };
  Eigen::MatrixXi tets(4, 6 * cubes);
  for (int cube = 0; cube < cubes; ++cube) {
    for (int t = 0; t < 6; ++t) {
      tets.col(6 * cube + t) << node(cube, 0), node(cube, path[t][0]), node(cube, path[t][1]),
          node(cube, path[t][2]);
    }
  }
  return tets;
}

TEST(BlockPattern, ContainsABlockExactlyForNodesThatShareAnElement) {
  const int nodes = 24;
  const Eigen::MatrixXi tets = RowOfCubes(5);
  std::set<std::pair<int, int>> expected;
  for (int i = 0; i < nodes; ++i) expected.emplace(i, i);
  for (Eigen::Index e = 0; e < tets.cols(); ++e) {
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) expected.emplace(tets(a, e), tets(b, e));
    }
  }

  const BlockPattern pattern = MakeBlockPattern(nodes, tets);

  ASSERT_EQ(pattern.BlockCount(), static_cast<int>(expected.size()));
  for (int i = 0; i < nodes; ++i) {
    for (int j = 0; j < nodes; ++j) {
      const int k = pattern.Find(i, j);
      ASSERT_EQ(k >= 0, expected.count({i, j}) == 1) << i << ", " << j;
      if (k >= 0) {
        EXPECT_EQ(pattern.column[k], j);
        EXPECT_TRUE(pattern.row_begin[i] <= k && k < pattern.row_begin[i + 1]);
      }
    }
    EXPECT_EQ(pattern.diagonal[i], pattern.Find(i, i));
  }
}

TEST(BlockPattern, ContainsTheDiagonalBlockOfANodeWithoutElements) {
  const BlockPattern pattern = MakeBlockPattern(9, RowOfCubes(1));
  EXPECT_EQ(pattern.Find(8, 8), pattern.BlockCount() - 1);
  EXPECT_EQ(pattern.Find(8, 0), -1);
}

TEST(BlockMatrix, MultipliesLikeItsDenseCounterpart) {
  const int cubes = 500, nodes = 4 * (cubes + 1);
  BlockMatrix matrix(std::make_shared<BlockPattern>(MakeBlockPattern(nodes, RowOfCubes(cubes))));
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  Eigen::VectorXd x(3 * nodes), expected = Eigen::VectorXd::Zero(3 * nodes), y;
  for (double& value : x) value = normal(random);
  const BlockPattern& pattern = matrix.pattern();
  for (int i = 0; i < nodes; ++i) {
    for (int k = pattern.row_begin[i]; k < pattern.row_begin[i + 1]; ++k) {
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
          matrix.Block(k)(r, c) = normal(random);
          expected[3 * i + r] += matrix.Block(k)(r, c) * x[3 * pattern.column[k] + c];
        }
      }
    }
  }

  matrix.Multiply(x, &y);
  // Rounding of sums of at most 36 terms of order one in a different order.
  EXPECT_LT((y - expected).lpNorm<Eigen::Infinity>(), 1e-12);

  Eigen::VectorXd on_one_thread;
  const int threads = ThreadCount();
  SetThreadCount(1);
  matrix.Multiply(x, &on_one_thread);
  SetThreadCount(threads);
  EXPECT_EQ(y, on_one_thread);

  matrix.SetZero();
  matrix.Multiply(x, &y);
  EXPECT_EQ(y, Eigen::VectorXd::Zero(3 * nodes));
}

}  // namespace
}  // namespace lacuna
