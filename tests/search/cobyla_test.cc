#include "search/cobyla.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "search/problem_collection.h"

namespace lacuna {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;
using ::testing::Le;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr CobylaMode kBothModes[] = {CobylaMode::kPowell, CobylaMode::kModern};

SearchProblem InBox(const VectorXd& start, double lower, double upper,
                    std::function<double(const VectorXd&)> f) {
  SearchProblem problem;
  problem.start = start;
  problem.lower = VectorXd::Constant(start.size(), lower);
  problem.upper = VectorXd::Constant(start.size(), upper);
  problem.evaluate = [f](const VectorXd& x) { return Evaluation{f(x), VectorXd(0), ""}; };
  return problem;
}

double Bowl(const VectorXd& x) { return (x.array() - 0.3).square().sum(); }

// Runs a search and checks the properties that hold for every objective.
SearchResult Checked(const SearchProblem& problem, const CobylaOptions& options,
                     int max_evaluations = 500) {
  SearchControl control;
  control.max_evaluations = max_evaluations;
  const SearchResult result = MinimiseByCobyla(problem, control, options);
  EXPECT_LE(result.trace.size(), max_evaluations);
  std::set<std::vector<double>> seen;
  double least = kInf;
  for (const SearchStep& step : result.trace) {
    EXPECT_TRUE((step.x.array() >= problem.lower.array()).all());
    EXPECT_TRUE((step.x.array() <= problem.upper.array()).all());
    EXPECT_TRUE(seen.emplace(step.x.begin(), step.x.end()).second) << "evaluated twice";
    if (step.outcome.value && Violation(step.outcome.constraints) <= 1e-6) {
      least = std::min(least, *step.outcome.value);
    }
  }
  if (least < kInf) {
    EXPECT_EQ(result.value(), least) << "not the best point seen";
    EXPECT_LE(result.violation(), 1e-6);
  }
  return result;
}

CobylaOptions Options(CobylaMode mode, double initial_radius = 0.25, double ratio = 1e-4) {
  CobylaOptions options;
  options.mode = mode;
  options.initial_radius = initial_radius;
  options.final_radius = ratio * initial_radius;
  return options;
}

// Counts of Powell's program in double precision, final radius 1e-3 and 1e-4, measured; the counts
// that he published (single precision) are the same within 4 for all but P04, P08, P09 and P10.
// Where steps of equal length tie, as they do without constraints, the count hangs on rounding: for
// starts moved by less than 1e-6 the same program takes 46 to 69 evaluations for P01, 137 to 180
// for P04 and 666 to 967 for P05 (1e-4). These bounds hold those spreads.
TEST(Cobyla, PowellsRulesNeedAsManyEvaluationsAsPowellsProgram) {
  struct Reference {
    int coarse, fine;
    double allowed;  // evaluations if >= 1, else a share
  };
  const std::map<std::string, Reference> references = {
      {"P01_quad", {37, 61, 8}},       {"P02_circle", {37, 46, 2}},
      {"P03_ellips", {52, 65, 2}},     {"P04_wrosen", {105, 155, 0.2}},
      {"P05_irosen", {338, 699, 0.3}}, {"P06_fl9115", {30, 41, 2}},
      {"P07_fl1442", {28, 32, 2}},     {"P08_rosuz", {69, 86, 0.2}},
      {"P09_hs100", {241, 308, 0.2}},  {"P10_hexagon", {165, 207, 0.2}}};
  int compared = 0;
  for (const KnownProblem& known : SmoothProblems()) {
    const auto reference = references.find(known.name);
    if (reference == references.end()) continue;
    for (const bool fine : {false, true}) {
      const int expected = fine ? reference->second.fine : reference->second.coarse;
      const double allowed = reference->second.allowed;
      CobylaOptions options = Options(CobylaMode::kPowell, 0.5);
      options.final_radius = fine ? 1e-4 : 1e-3;
      const SearchResult result = Checked(known.problem, options, 2000);
      EXPECT_EQ(result.status, SearchStatus::kConverged) << known.name;
      EXPECT_NEAR(static_cast<double>(result.trace.size()), expected,
                  allowed >= 1 ? allowed : allowed * expected)
          << known.name;
      ++compared;
    }
  }
  EXPECT_EQ(compared, 20);
}

// 1e-3 of the minimum's size is what a first-order method with this final radius reaches where the
// valley is not as curved as Rosenbrock's.
TEST(Cobyla, ReachesTheKnownMinimaInBothModes) {
  const std::set<std::string> slow = {"HS001",     "HS002",      "HS038_4d",
                                      "ROSB4_int", "P05_irosen", "P10_hexagon"};
  for (const CobylaMode mode : kBothModes) {
    for (const KnownProblem& known : SmoothProblems()) {
      const SearchResult result = Checked(known.problem, Options(mode, known.radius),
                                          slow.contains(known.name) ? 800 : 5000);
      ASSERT_TRUE(result.IsUsable()) << known.name;
      if (slow.contains(known.name)) continue;
      EXPECT_LT(result.value() - known.minimum, 1e-3 * std::max(1.0, std::abs(known.minimum)))
          << known.name;
    }
  }
}

// The geometric mean of the ratios is tested because a single ratio varies by half with the start.
TEST(Cobyla, ModernRulesNeedFewerEvaluationsThanPowells) {
  double log_ratio = 0;
  int count = 0;
  for (const KnownProblem& known : SmoothProblems()) {
    if (known.family != "hs" || known.name == "HS001" || !known.other_minima.empty()) continue;
    const auto evaluations = [&](CobylaMode mode) {
      return static_cast<double>(
          Checked(known.problem, Options(mode, known.radius), 5000).trace.size());
    };
    log_ratio += std::log(evaluations(CobylaMode::kModern) / evaluations(CobylaMode::kPowell));
    ++count;
  }
  EXPECT_LT(std::exp(log_ratio / count), 0.85);  // 0.7 when this was written
}

// Linear models are exact here: the first resolved step ends on the vertex, to rounding.
TEST(Cobyla, SolvesLinearProgramsToTheirVertex) {
  for (const CobylaMode mode : kBothModes) {
    SearchProblem problem = InBox(Vector2d(0.1, 0.2), 0, 4, [](const VectorXd&) { return 0.0; });
    problem.constraint_count = 2;
    problem.evaluate = [](const VectorXd& x) {
      return Evaluation{-2 * x[0] - 3 * x[1], Vector2d(4 - x[0] - 2 * x[1], 5 - 2 * x[0] - x[1]),
                        ""};
    };
    const SearchResult result = Checked(problem, Options(mode, 0.5), 100);
    EXPECT_NEAR(result.value(), -7, 1e-9);
    EXPECT_NEAR(result.x()[0], 2, 1e-9);
    EXPECT_NEAR(result.x()[1], 1, 1e-9);
  }
}

TEST(Cobyla, ALinearObjectiveEndsInTheCornerOfTheBox) {
  for (const CobylaMode mode : kBothModes) {
    const SearchResult result =
        Checked(InBox(Vector2d(-1.5, -1.5), -3, 3, [](const VectorXd& x) { return x[1] - x[0]; }),
                Options(mode, 0.5));
    EXPECT_EQ(result.value(), -6);
    EXPECT_LT(result.trace.size(), 60);
  }
}

TEST(Cobyla, AFlatMinimumAndATinyFinalRadiusDoNotHang) {
  for (const CobylaMode mode : kBothModes) {
    const auto flat = [](const VectorXd& x) {
      return std::pow(2 - std::cos(x[0]) + x[1] * x[1], 2);
    };
    EXPECT_EQ(Checked(InBox(Vector2d(0, 0), -kInf, kInf, flat), Options(mode, 0.5, 1e-300)).value(),
              1);
    EXPECT_EQ(Checked(InBox(VectorXd::Constant(4, 0.6), 0, 1, [](const VectorXd&) { return 1.0; }),
                      Options(mode))
                  .value(),
              1);
  }
}

TEST(Cobyla, StartsAtBoundsWithStepsWiderThanTheBox) {
  for (const CobylaMode mode : kBothModes) {
    for (const double start : {0.0, 0.9, 1.0}) {
      const SearchResult result =
          Checked(InBox(VectorXd::Constant(4, start), 0, 1, Bowl), Options(mode, 1));
      EXPECT_LT(result.value(), 1e-6);  // the final radius squared, times a safe hundred
    }
  }
}

TEST(Cobyla, FixedVariablesStayAndCostNothing) {
  for (const CobylaMode mode : kBothModes) {
    SearchProblem problem = InBox(VectorXd::Constant(4, 0.6), 0, 1, Bowl);
    problem.lower[1] = problem.upper[1] = problem.start[1] = 0.5;
    const SearchResult result = Checked(problem, Options(mode));
    EXPECT_EQ(result.x()[1], 0.5);
    EXPECT_NEAR(result.value(), 0.04, 1e-6);
    problem.lower = problem.upper = problem.start;
    EXPECT_EQ(Checked(problem, Options(mode)).status, SearchStatus::kAllFixed);
  }
}

TEST(Cobyla, NanAndInfinityAreFailuresAndNeverTheResult) {
  for (const CobylaMode mode : kBothModes) {
    for (const double bad : {kNaN, kInf, -kInf}) {
      const VectorXd start = VectorXd::Constant(4, 0.6);
      // The minimum lies in the failing half: the best available point is at 0.35.
      const SearchResult wall = Checked(
          InBox(start, 0, 1, [=](const VectorXd& x) { return x[0] < 0.35 ? bad : Bowl(x); }),
          Options(mode));
      EXPECT_GT(wall.failures, 0);
      EXPECT_LT(wall.value(), 0.02);
      const SearchResult first =
          Checked(InBox(start, 0, 1, [=](const VectorXd& x) { return x == start ? bad : Bowl(x); }),
                  Options(mode));
      EXPECT_LT(first.value(), 1e-6);
      const SearchResult vertex =
          Checked(InBox(start, 0, 1, [=](const VectorXd& x) { return x[1] > 0.8 ? bad : Bowl(x); }),
                  Options(mode));
      EXPECT_LT(vertex.value(), 1e-6);
      const SearchResult all =
          Checked(InBox(start, 0, 1, [=](const VectorXd&) { return bad; }), Options(mode));
      EXPECT_FALSE(all.IsUsable());
      EXPECT_EQ(all.status, SearchStatus::kNoValue);
    }
  }
}

// The first simplex must not be flat where no neighbour along an axis can be evaluated.
TEST(Cobyla, ContinuesFromABoundBesideWhichAllEvaluationsFail) {
  for (const CobylaMode mode : kBothModes) {
    const SearchResult result =
        Checked(InBox(VectorXd::Zero(2), 0, 1,
                      [](const VectorXd& x) { return x[0] > 0 && x[0] < 0.9 ? kNaN : Bowl(x); }),
                Options(mode, 0.05));
    EXPECT_GT(result.failures, 1);
    EXPECT_EQ(result.x()[0], 0);
    EXPECT_NEAR(result.x()[1], 0.3, 0.1);  // the first simplex ends at 0.05
  }
}

TEST(Cobyla, ReportsTheLimitThatHasEndedASearchWithoutAnyValue) {
  for (const CobylaMode mode : kBothModes) {
    const SearchResult result =
        Checked(InBox(VectorXd::Constant(4, 0.6), 0, 1, [](const VectorXd&) { return kNaN; }),
                Options(mode), 3);
    EXPECT_FALSE(result.IsUsable());
    EXPECT_EQ(result.status, SearchStatus::kEvaluations);
  }
}

TEST(Cobyla, RegionsOfFailuresNeitherHangNorLoseTheBestPoint) {
  for (const CobylaMode mode : kBothModes) {
    for (int seed = 0; seed < 100; ++seed) {
      VectorXd start(4);
      for (int i = 0; i < 4; ++i) start[i] = UniformOf(10 * seed + i);
      Checked(InBox(start, 0, 1,
                    [seed](const VectorXd& x) {
                      uint64_t cell = seed;
                      for (const double c : x) cell = cell * 31 + static_cast<uint64_t>(c * 10);
                      return UniformOf(cell) < 0.1 ? kNaN : Bowl(x) + 0.01 * UniformOf(cell + 1);
                    }),
              Options(mode, 0.25, 1e-3), 200);
    }
  }
}

TEST(Cobyla, RespectsAnyBudget) {
  for (const CobylaMode mode : kBothModes) {
    for (int budget = 1; budget < 20; ++budget) {
      EXPECT_EQ(Checked(InBox(VectorXd::Constant(4, 0.6), 0, 1, Bowl), Options(mode), budget)
                    .trace.size(),
                budget);
    }
  }
}

// The start is an isolated minimum, around which each simplex is soon known: after the first
// simplex with the least radius on the upper side, one on the lower side follows.
TEST(Cobyla, ARestartThatFindsNothingNewReflectsTheSimplex) {
  const VectorXd start = VectorXd::Constant(2, 0.5);
  CobylaOptions options = Options(CobylaMode::kModern);
  options.restarts.max_restarts = 1000;
  const SearchResult result = Checked(
      InBox(start, 0, 1, [&](const VectorXd& x) { return x == start ? 0.0 : 1.0; }), options, 1000);
  EXPECT_EQ(result.status, SearchStatus::kConverged);
  int below = 0;
  for (const SearchStep& step : result.trace) {
    below += step.x[1] == 0.5 && std::abs(step.x[0] - 0.48) < 1e-12;  // rounding
  }
  EXPECT_EQ(below, 1);
}

// A step below a tenth of the resolution is not continued, but it may be the best point. Only
// constraints make steps that short.
TEST(Cobyla, ModernRulesTryTheLastShortStep) {
  int tried = 0;
  for (const KnownProblem& known : SmoothProblems()) {
    if (known.problem.constraint_count == 0) continue;
    const CobylaOptions options = Options(CobylaMode::kModern, known.radius);
    const SearchResult result = Checked(known.problem, options, 2000);
    double nearest = kInf;
    for (size_t i = 0; i + 1 < result.trace.size(); ++i) {
      nearest = std::min(nearest, (result.trace[i].x - result.trace.back().x).norm());
    }
    tried += nearest <= 0.1 * options.final_radius;
  }
  EXPECT_GT(tried, 3);
}

// The median over eleven noises, for two shares of failures; the box is 1 wide and the start is at
// 0.13. Without restarts the same searches end farther from the minimum.
TEST(Cobyla, RestartsDescendASteppedValley) {
  for (const double failing : {0.0, 0.03}) {
    std::vector<double> with, without;
    for (int seed = 0; seed < 11; ++seed) {
      const SteppedProblem stepped = MakeSteppedProblem(0.01, failing, seed);
      CobylaOptions options = Options(CobylaMode::kModern);
      options.final_radius = 1e-3;
      without.push_back(stepped.smooth(Checked(stepped.problem, options, 100).x()));
      options.restarts.max_restarts = 1000;
      with.push_back(stepped.smooth(Checked(stepped.problem, options, 100).x()));
    }
    std::nth_element(with.begin(), with.begin() + 5, with.end());
    std::nth_element(without.begin(), without.begin() + 5, without.end());
    EXPECT_LT(with[5], 0.02);
    EXPECT_LT(with[5], without[5]);
  }
}

}  // namespace
}  // namespace lacuna
