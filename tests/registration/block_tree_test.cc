#include "registration/block_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <vector>

#include "registration/warped_body.h"

namespace lacuna {
namespace {

Eigen::Matrix3Xf Ordered(const Eigen::Matrix3Xf& points) {
  const std::vector<int> order = SpatialOrder(points);
  Eigen::Matrix3Xf sorted(3, points.cols());
  for (size_t i = 0; i < order.size(); ++i) sorted.col(i) = points.col(order[i]);
  return sorted;
}

TEST(BlockTreeTest, SpatialOrderIsAPermutationOfCompactRuns) {
  const Eigen::Matrix3Xf points = SampleBody(1000, 1).points.cast<float>();
  std::vector<int> order = SpatialOrder(points);
  const Eigen::Matrix3Xf sorted = Ordered(points);
  std::sort(order.begin(), order.end());
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(order[i], i);
  double run = 0.0, shuffled = 0.0;
  for (int i = 0; i + 8 <= 1000; i += 8) {
    const auto width = [&](const Eigen::Matrix3Xf& p) {
      return (p.middleCols(i, 8).rowwise().maxCoeff() - p.middleCols(i, 8).rowwise().minCoeff())
          .norm();
    };
    run += width(sorted);
    shuffled += width(points);
  }
  // 8 of 1000 points of a surface in a compact patch: √(8/1000) ≈ 0.09 of its width.
  EXPECT_LT(run, 0.25 * shuffled);
}

TEST(BlockTreeTest, NoPointWithinTheRadiusIsMissed) {
  for (const int count : {1, 7, 8, 9, 100, 777}) {
    const Eigen::Matrix3Xf points = Ordered(SampleBody(count, 2).points.cast<float>());
    BlockTree tree(Eigen::Matrix3Xf::Zero(3, count));
    tree.Move(points);
    constexpr float kRadius = 0.03f;
    std::vector<int> leaves;
    for (int block = 0; block < tree.QueryBlockCount(); ++block) {
      tree.LeavesWithin(tree.QueryBox(block), kRadius, &leaves);
      ASSERT_TRUE(std::is_sorted(leaves.begin(), leaves.end()));
      const std::set<int> found(leaves.begin(), leaves.end());
      for (int q = block * kQueryBlock; q < std::min(count, (block + 1) * kQueryBlock); ++q) {
        for (int p = 0; p < count; ++p) {
          if ((points.col(p) - points.col(q)).norm() > kRadius) continue;
          ASSERT_TRUE(found.count(p / kLeaf)) << "pair " << q << ", " << p << " of " << count;
        }
      }
      if (count == 777) {
        EXPECT_LT(leaves.size(), 777u / kLeaf);
      }
    }
  }
}

}  // namespace
}  // namespace lacuna
