// The common interface of all searches: the problem, the stopping rules and the result.
//
//   minimise f(x)   subject to   c_i(x) >= 0, i < m,   lower <= x <= upper
//
// One evaluation gives f and all c_i at one x. An evaluation may fail, for example because meshing
// failed or a time step did not converge; the outcome then has no value. No search evaluates
// outside the bounds or twice at the same x.
#ifndef LACUNA_SEARCH_SEARCH_PROBLEM_H_
#define LACUNA_SEARCH_SEARCH_PROBLEM_H_

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace lacuna {

struct Evaluation {
  // f(x); empty if the evaluation failed. A value or constraint that is not finite also counts as a
  // failure.
  std::optional<double> value;
  Eigen::VectorXd constraints;  // m, feasible if >= 0; empty after a failure
  std::string failure;          // the reason if there is no value, on one line
};

struct SearchProblem {
  Eigen::VectorXd lower, upper;  // n each; infinite if there is no bound; equal if x_i is fixed
  Eigen::VectorXd start;         // n, within the bounds
  int constraint_count = 0;      // m
  // The objective. It is called from one thread, in an order that depends only on its results. If
  // it throws an exception, the search ends with that exception; the log keeps the earlier
  // evaluations.
  std::function<Evaluation(const Eigen::VectorXd& x)> evaluate;
  // ∂f/∂x (n) at an x whose evaluation has succeeded; NaN for derivatives that must be approximated
  // by finite differences. May be empty. Used by gradient searches only (fit/gradient_search.h).
  std::function<Eigen::VectorXd(const Eigen::VectorXd& x)> gradient = {};
};

// The stopping rules and the log of a search.
struct SearchControl {
  int max_evaluations = 500;  // distinct points, including those read from the log
  // The largest violation of a constraint at which a point still counts as feasible.
  double feasibility_tolerance = 1e-6;
  std::filesystem::path log;  // the file of the evaluation log (evaluation_log.h); none if empty
  std::string log_key;        // identifies the objective in the log (evaluation_log.h)
};

enum class SearchStatus {
  kNotRun,
  kConverged,       // the final resolution was reached
  kEvaluations,     // max_evaluations was reached
  kRounding,        // steps became too small for double precision
  kNoValue,         // no evaluation near the start succeeded
  kAllFixed,        // no variable is free; the only point has been evaluated
  kIterationLimit,  // the limit on iterations was reached
  kLibrary,         // an external library failed; see the message
};

const char* ToString(SearchStatus status);

// One evaluation of a search. x includes the fixed variables.
struct SearchStep {
  Eigen::VectorXd x;
  Evaluation outcome;
  bool from_log = false;
};

// The best point is chosen by one rule from all evaluations: the least value among the feasible
// points (violation <= feasibility_tolerance); if there are none, the least violation and then the
// least value. The first of several equal points is chosen.
struct SearchResult {
  SearchStatus status = SearchStatus::kNotRun;
  std::string message;
  std::optional<int> best;  // index into trace; empty if no evaluation succeeded
  std::vector<SearchStep> trace;
  int failures = 0;
  std::string trace_hash;  // hash of all x and outcomes in order; equal for identical searches

  bool IsUsable() const { return best.has_value(); }
  // The best point, its value and its violation; only valid if IsUsable().
  const Eigen::VectorXd& x() const { return trace[*best].x; }
  double value() const { return *trace[*best].outcome.value; }
  double violation() const;  // max(0, max_i -c_i)
};

// The largest violation max(0, max_i -c_i) of the constraints.
double Violation(const Eigen::VectorXd& constraints);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_SEARCH_PROBLEM_H_
