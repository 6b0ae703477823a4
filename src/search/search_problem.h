// What every search of this module sees, and what it gives back.
//
//   minimise f(x)   subject to   c_i(x) >= 0, i < m,   lower <= x <= upper
//
// One evaluation gives f and all c_i at one x. It may fail (a mesh was refused, a step did not
// converge): that is an outcome of its own, never a number. No search evaluates outside the bounds,
// nor twice at the same x.
#ifndef LACUNA_SEARCH_SEARCH_PROBLEM_H_
#define LACUNA_SEARCH_SEARCH_PROBLEM_H_

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace lacuna {

struct Evaluation {
  // f(x); none where the evaluation failed. A value or constraint that is not finite counts as a
  // failure.
  std::optional<double> value;
  Eigen::VectorXd constraints;  // m, feasible where >= 0; empty after a failure
  std::string failure;          // why there is no value; one line
};

struct SearchProblem {
  Eigen::VectorXd lower, upper;  // n each; infinite where there is no bound; equal: x is fixed
  Eigen::VectorXd start;         // n, within the bounds
  int constraint_count = 0;      // m
  // Called from one thread, in an order that depends on its results alone. It may throw: the search
  // ends there, and what was evaluated before stands in the log.
  std::function<Evaluation(const Eigen::VectorXd& x)> evaluate;
  // ∂f/∂x (n) at an x whose evaluation has succeeded; NaN where only differences can tell. May be
  // empty. Only searches by the gradient ask (fit/gradient_search.h).
  std::function<Eigen::VectorXd(const Eigen::VectorXd& x)> gradient = {};
};

// When to stop, and what to keep.
struct SearchControl {
  int max_evaluations = 500;  // distinct points, those read from the log among them
  // Wall time in seconds, looked at before each evaluation. A search stopped by it goes on from its
  // log when called again.
  double max_seconds = std::numeric_limits<double>::infinity();
  std::function<bool()> interrupted;  // asked before each evaluation; may be empty
  // The largest violation of a constraint at which a point still counts as feasible.
  double feasibility_tolerance = 1e-6;
  std::filesystem::path log;  // where each evaluation is kept; none if empty (evaluation_log.h)
  std::string log_key;        // names the objective: a log of another one is refused
};

enum class SearchStatus {
  kNotRun,
  kConverged,       // the final resolution was reached
  kEvaluations,     // max_evaluations
  kTime,            // max_seconds
  kInterrupted,     // control.interrupted
  kRounding,        // steps became too small for the arithmetic
  kNoValue,         // no evaluation near the start succeeded
  kAllFixed,        // no variable was free: the one point has been evaluated
  kIterationLimit,  // the cap on iterations without an evaluation
  kLibrary,         // a library behind the seam gave up; see message
};

const char* ToString(SearchStatus status);

struct SearchStep {
  Eigen::VectorXd x;
  Evaluation outcome;
  bool from_log = false;
};

// The best point by one rule, over every evaluation made: among the feasible ones (violation <=
// feasibility_tolerance) the least value, otherwise the least violation and then the least value;
// the first of equals.
struct SearchResult {
  SearchStatus status = SearchStatus::kNotRun;
  std::string message;
  std::optional<int> best;  // index into trace; none if no evaluation succeeded
  std::vector<SearchStep> trace;
  int failures = 0;
  std::string trace_hash;  // of all x and outcomes, in order: equal for equal searches

  bool IsUsable() const { return best.has_value(); }
  // Of the best point; only where IsUsable().
  const Eigen::VectorXd& x() const { return trace[*best].x; }
  double value() const { return *trace[*best].outcome.value; }
  double violation() const;  // max(0, max_i -c_i)
};

// max(0, max_i -c_i).
double Violation(const Eigen::VectorXd& constraints);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_SEARCH_PROBLEM_H_
