#include "search/search_space.h"

#include <gtest/gtest.h>

#include <vector>

#include "search/cobyla.h"

namespace lacuna {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

SearchSpace MakeSpace() {
  return SearchSpace({{"quality", 1.1, 2, 1.4, SearchScale::kLinear},
                      {"young_modulus", 1e3, 1e5, 1e4, SearchScale::kLogarithmic},
                      {"poisson_ratio", 0.3, 0.3, 0.3, SearchScale::kLinear}});
}

TEST(SearchSpace, ALogarithmicScaleHalvesTheDecades) {
  const VectorXd x = MakeSpace().FromUnit(Vector3d(0.5, 0.5, 0));
  EXPECT_DOUBLE_EQ(x[0], 1.55);
  EXPECT_NEAR(x[1], 1e4, 1e-8);  // rounding of pow
  EXPECT_EQ(x[2], 0.3);
}

TEST(SearchSpace, TheEndsAreTheBoundsExactly) {
  EXPECT_EQ(MakeSpace().FromUnit(Vector3d(0, 0, 0)), Vector3d(1.1, 1e3, 0.3));
  EXPECT_EQ(MakeSpace().FromUnit(Vector3d(1, 1, 0)), Vector3d(2, 1e5, 0.3));
}

TEST(SearchSpace, ToUnitAndBackIsTheSamePoint) {
  const SearchSpace space = MakeSpace();
  const Vector3d x(1.37, 4321, 0.3);
  EXPECT_NEAR((space.FromUnit(space.ToUnit(x)) - x).norm(), 0, 1e-9);  // rounding of log and pow
}

TEST(SearchSpace, ASearchEvaluatesTheObjectiveInSiUnits) {
  const SearchProblem problem = MakeSpace().ProblemOf([](const VectorXd& x) {
    EXPECT_TRUE(1.1 <= x[0] && x[0] <= 2 && 1e3 <= x[1] && x[1] <= 1e5 && x[2] == 0.3);
    Evaluation outcome;
    outcome.value = std::pow(std::log(x[1] / 3e4), 2) + std::pow(x[0] - 1.2, 2);
    return outcome;
  });
  CobylaOptions options;
  options.final_radius = 1e-5;
  const SearchResult result = MinimiseByCobyla(problem, {}, options);
  const VectorXd x = MakeSpace().FromUnit(result.x());
  EXPECT_NEAR(x[0], 1.2, 1e-3);
  EXPECT_NEAR(x[1] / 3e4, 1, 1e-3);  // some ten final radii, in units of two decades
}

TEST(SearchSpace, GradientsFollowTheScale) {
  const SearchSpace space = MakeSpace();
  const Vector3d u(0.4, 0.7, 0);
  for (int i = 0; i < 2; ++i) {
    const double h = 1e-6;
    const VectorXd step = h * VectorXd::Unit(3, i);
    const double difference = (space.FromUnit(u + step) - space.FromUnit(u - step))[i] / (2 * h);
    EXPECT_NEAR(space.SlopeAt(u)[i] / difference, 1, 1e-8);  // truncation and rounding
  }
  EXPECT_EQ(space.SlopeAt(u)[2], 0);
  const SearchProblem problem =
      space.ProblemOf({}, 0, [](const VectorXd&) -> VectorXd { return Vector3d(1, 2, 3); });
  EXPECT_EQ(problem.gradient(u)[1], 2 * space.SlopeAt(u)[1]);
}

TEST(SearchSpaceDeath, RefusesALogarithmicScaleFromZero) {
  EXPECT_DEATH(SearchSpace({{"volume", 0, 1, 0.5, SearchScale::kLogarithmic}}), "volume");
}

}  // namespace
}  // namespace lacuna
