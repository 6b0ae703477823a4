#include "fit/gradient_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// A curved valley over [0, 1]² with its minimum at `least` if that lies inside.
struct Valley {
  Vector2d least{0.3, 0.6};
  int evaluations = 0;
  bool knows_first = true, knows_second = true;

  SearchProblem Problem() {
    SearchProblem problem;
    problem.lower = Vector2d(0, 0);
    problem.upper = Vector2d(1, 1);
    problem.start = Vector2d(0.8, 0.2);
    problem.evaluate = [this](const VectorXd& x) {
      ++evaluations;
      EXPECT_TRUE((x.array() >= 0).all() && (x.array() <= 1).all());
      const double bend = x[1] - least[1] - 0.5 * (x[0] - least[0]);
      Evaluation outcome;
      outcome.value = 1 + std::pow(x[0] - least[0], 2) + 4 * bend * bend;
      return outcome;
    };
    problem.gradient = [this](const VectorXd& x) {
      const double bend = x[1] - least[1] - 0.5 * (x[0] - least[0]);
      VectorXd gradient = Vector2d(2 * (x[0] - least[0]) - 4 * bend, 8 * bend);
      if (!knows_first) gradient[0] = kUnknown;
      if (!knows_second) gradient[1] = kUnknown;
      return gradient;
    };
    return problem;
  }
};

SearchControl Budget(int evaluations) {
  SearchControl control;
  control.max_evaluations = evaluations;
  return control;
}

TEST(GradientSearch, FindsTheMinimumInFewEvaluations) {
  Valley valley;
  const SearchResult found = MinimiseByGradient(valley.Problem(), Budget(100), {});
  EXPECT_EQ(found.status, SearchStatus::kConverged);
  EXPECT_LT((found.x() - valley.least).norm(), 1e-2);  // ten final radii
  EXPECT_LT(valley.evaluations, 25);                   // a simplex search needs about fifty
  EXPECT_NE(found.message.find(" 0 derivatives by differences"), std::string::npos)
      << found.message;
}

TEST(GradientSearch, TheFirstStepHasTheGivenLength) {
  Valley valley;
  for (const double radius : {0.05, 0.2}) {
    GradientSearchOptions options;
    options.initial_radius = radius;
    const SearchResult found = MinimiseByGradient(valley.Problem(), Budget(2), options);
    // Outside mid-range steps are shorter; sin t is 0.8 at the start.
    const double length = (found.trace[1].x - found.trace[0].x).norm();
    EXPECT_GT(length, 0.6 * radius);
    EXPECT_LE(length, 1.05 * radius);
  }
}

TEST(GradientSearch, ReplacesMissingDerivativesByDifferencesAndCountsThem) {
  Valley valley;
  valley.knows_first = false;
  const SearchResult found = MinimiseByGradient(valley.Problem(), Budget(200), {});
  EXPECT_LT((found.x() - valley.least).norm(),
            1e-2);  // central differences are exact for a parabola
  EXPECT_EQ(static_cast<int>(found.trace.size()), valley.evaluations);
  EXPECT_EQ(found.message.find(" 0 derivatives by differences"), std::string::npos);

  // Without any derivatives, two differences are needed at each point.
  Valley blind;
  SearchProblem problem = blind.Problem();
  problem.gradient = nullptr;
  EXPECT_LT((MinimiseByGradient(problem, Budget(200), {}).x() - blind.least).norm(), 1e-2);
  EXPECT_GT(blind.evaluations, valley.evaluations);
}

TEST(GradientSearch, StaysWithinBoundsIfTheMinimumLiesOutside) {
  Valley valley;
  valley.least = {-0.4, 0.25};
  const SearchResult found = MinimiseByGradient(valley.Problem(), Budget(200), {});
  EXPECT_LT(found.x()[0], 1e-2);  // a bound is a stationary point of t and reached to some radii
}

TEST(GradientSearch, UsesAOneSidedDifferenceIfOneSideFails) {
  Valley valley;
  valley.knows_first = false;
  SearchProblem problem = valley.Problem();
  const auto whole = problem.evaluate;
  problem.evaluate = [&](const VectorXd& x) {
    if (x[0] <= 0.85) return whole(x);
    Evaluation failed;
    failed.failure = "beyond what can be evaluated";
    return failed;
  };
  const SearchResult found = MinimiseByGradient(problem, Budget(200), {});
  EXPECT_GT(found.failures, 0);
  EXPECT_LT((found.x() - valley.least).norm(), 2e-2);
}

TEST(GradientSearch, AnInterruptedSearchResumesWithTheSameTrace) {
  const TemporaryFolder folder;
  Valley valley;
  valley.knows_second = false;
  SearchControl control = Budget(30);
  control.log_key = "valley";
  const SearchResult whole = MinimiseByGradient(valley.Problem(), control, {});
  const int count = static_cast<int>(whole.trace.size());
  ASSERT_GT(count, 8);
  for (const int stop : {0, 1, 5, 8}) {
    control.log = folder / std::to_string(stop);
    SearchProblem dying = valley.Problem();
    const auto evaluate = dying.evaluate;
    int calls = 0;
    dying.evaluate = [&](const VectorXd& x) {
      if (calls++ == stop) throw std::runtime_error("killed");
      return evaluate(x);
    };
    EXPECT_THROW(MinimiseByGradient(dying, control, {}), std::runtime_error);
    valley.evaluations = 0;
    const SearchResult resumed = MinimiseByGradient(valley.Problem(), control, {});
    EXPECT_EQ(resumed.trace_hash, whole.trace_hash) << "stopped at " << stop;
    EXPECT_EQ(valley.evaluations, count - stop) << "evaluated again";
  }
}

TEST(GradientSearch, WithoutFreeVariablesTakesOneEvaluation) {
  Valley valley;
  SearchProblem problem = valley.Problem();
  problem.lower = problem.upper = problem.start;
  EXPECT_EQ(MinimiseByGradient(problem, Budget(30), {}).status, SearchStatus::kAllFixed);
  EXPECT_EQ(valley.evaluations, 1);
}

}  // namespace
}  // namespace lacuna
