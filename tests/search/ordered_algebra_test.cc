#include "search/ordered_algebra.h"

#include <gtest/gtest.h>

namespace lacuna {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;

// A compiler that contracted the product and the sum into one operation would leave the rounding
// error of the square, 2^-60.
TEST(OrderedAlgebra, IsCompiledWithoutContraction) {
  volatile double root = 1 + 0x1p-30;
  const double number = root;
  const double square = root * root;
  EXPECT_EQ(OrderedDot(Vector2d(-square, number), Vector2d(1, number)), 0);
}

TEST(OrderedAlgebra, InvertsWithPivotingAndRefusesSingularMatrices) {
  MatrixXd matrix(3, 3);
  matrix << 0, 2, 1, 1, 0, 3, 4, 1, 0;
  const std::optional<MatrixXd> inverse = OrderedInverse(matrix);
  ASSERT_TRUE(inverse);
  EXPECT_NEAR((*inverse * matrix - MatrixXd::Identity(3, 3)).norm(), 0, 1e-15);  // rounding
  matrix.col(2) = matrix.col(0) + matrix.col(1);
  EXPECT_FALSE(OrderedInverse(matrix));
}

TEST(OrderedAlgebra, TreatsLengthsThatDifferByRoundingAsEqual) {
  EXPECT_FALSE(ClearlyGreater(2 + 1e-15, 2));
  EXPECT_TRUE(ClearlyGreater(2 + 1e-9, 2));
}

}  // namespace
}  // namespace lacuna
