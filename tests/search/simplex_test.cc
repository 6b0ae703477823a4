#include "search/simplex.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "search/evaluator.h"

namespace lacuna {
namespace {

// f grows along all axes. Along the first of them all evaluations fail.
TEST(Simplex, AVertexThatCannotBeEvaluatedIsFarAboveAllOthers) {
  SearchProblem problem;
  problem.start = Eigen::Vector3d::Zero();
  problem.lower = Eigen::Vector3d::Constant(-1);
  problem.upper = Eigen::Vector3d::Constant(1);
  problem.evaluate = [](const Eigen::VectorXd& x) {
    Evaluation outcome{std::nullopt, Eigen::VectorXd(0), "fails"};
    if (x[0] == 0) outcome = {1 + x[1] + 10 * x[2], Eigen::VectorXd(0), ""};
    return outcome;
  };
  Evaluator evaluator(problem, {}, "test");
  const std::optional<Simplex> simplex = Simplex::Around(problem.start, 0.5, &evaluator);
  ASSERT_TRUE(simplex.has_value());
  EXPECT_EQ(simplex->value(simplex->pole()), 1);
  EXPECT_EQ(simplex->value(1), 1.5);
  EXPECT_EQ(simplex->value(2), 6);
  EXPECT_GE(simplex->value(0), 6 + (6 - 1));
  EXPECT_NE(simplex->Vertex(0)[0], 0);
}

}  // namespace
}  // namespace lacuna
