#include "search/nlopt_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "search/problem_collection.h"

namespace lacuna {
namespace {

using Eigen::VectorXd;

NloptOptions Options(NloptAlgorithm algorithm, double radius) {
  NloptOptions options;
  options.algorithm = algorithm;
  options.initial_radius = radius;
  options.final_radius = 1e-5 * radius;
  return options;
}

TEST(NloptSearch, CobylaFindsConstrainedMinima) {
  for (const KnownProblem& known : SmoothProblems()) {
    if (known.name != "P08_rosuz" && known.name != "HS035") continue;
    const SearchResult result =
        MinimiseByNlopt(known.problem, {}, Options(NloptAlgorithm::kCobyla, known.radius));
    EXPECT_EQ(result.status, SearchStatus::kConverged);
    EXPECT_NEAR(result.value(), known.minimum, 1e-4) << known.name;  // final radius, times a slope
    EXPECT_LE(result.violation(), 1e-6);
  }
}

TEST(NloptSearch, BobyqaFindsAMinimumInABox) {
  const SteppedProblem stepped = MakeSteppedProblem(0, 0, 1);
  const SearchResult result =
      MinimiseByNlopt(stepped.problem, {}, Options(NloptAlgorithm::kBobyqa, 0.25));
  EXPECT_LT(result.value(), 1e-6);
  EXPECT_LT(result.trace.size(), 200);
}

TEST(NloptSearch, ReturnsTheBestPointAndNeverAFailure) {
  for (const NloptAlgorithm algorithm : {NloptAlgorithm::kCobyla, NloptAlgorithm::kBobyqa}) {
    const SteppedProblem stepped = MakeSteppedProblem(0.02, 0.1, 5);
    SearchControl control;
    control.max_evaluations = 60;
    const SearchResult result = MinimiseByNlopt(stepped.problem, control, Options(algorithm, 0.25));
    ASSERT_GT(result.failures, 0);
    EXPECT_LE(result.trace.size(), 60);
    for (const SearchStep& step : result.trace) {
      if (step.outcome.value) {
        EXPECT_GE(*step.outcome.value, result.value());
      }
    }
  }
}

TEST(NloptSearch, AnExceptionOfTheObjectiveIsRethrown) {
  SearchProblem problem = MakeSteppedProblem(0, 0, 1).problem;
  problem.evaluate = [](const VectorXd&) -> Evaluation { throw std::runtime_error("interrupted"); };
  EXPECT_THROW(MinimiseByNlopt(problem, {}, {}), std::runtime_error);
}

}  // namespace
}  // namespace lacuna
