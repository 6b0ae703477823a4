// The interface between a search and its objective. It caches and logs the evaluations, applies the
// stopping rules, checks the bounds and keeps the best point.
#ifndef LACUNA_SEARCH_EVALUATOR_H_
#define LACUNA_SEARCH_EVALUATOR_H_

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "search/evaluation_log.h"
#include "search/search_problem.h"

namespace lacuna {

// A search works with the n free variables only: `lower`, `upper`, `start` and the points of At()
// omit the fixed ones (lower == upper).
class Evaluator {
 public:
  // `method` describes the search and its options. Together with the problem and control.log_key it
  // forms the key of the log. CHECKs that the problem is consistent. Throws InputError if the log
  // cannot be used (evaluation_log.h).
  Evaluator(const SearchProblem& problem, const SearchControl& control, const std::string& method);

  int n() const { return static_cast<int>(free_.size()); }  // number of free variables
  int m() const { return problem_.constraint_count; }       // number of constraints
  const Eigen::VectorXd& lower() const { return lower_; }
  const Eigen::VectorXd& upper() const { return upper_; }
  const Eigen::VectorXd& start() const { return start_; }
  // The point within the bounds that is nearest to `x` (n).
  Eigen::VectorXd Within(const Eigen::VectorXd& x) const {
    return x.cwiseMax(lower_).cwiseMin(upper_);
  }
  // The length of the first steps of a search that asks for `radius`: at most half of the narrowest
  // range of a free variable.
  double InitialRadius(double radius) const;

  // Returns the outcome at `free_x` (n), which must lie within the bounds (CHECK). A point is
  // evaluated once; later requests return the stored outcome. Returns null once the search must
  // stop. The pointer remains valid during the lifetime of the evaluator. Throws InputError if the
  // log contains another point in this place or cannot be written, and any exception of the
  // objective.
  const Evaluation* At(const Eigen::VectorXd& free_x);

  // ∂f/∂x (n) for the free variables at an `x` (n) whose outcome has a value; NaN if the problem
  // does not provide the derivative.
  Eigen::VectorXd GradientAt(const Eigen::VectorXd& x) const;

  double feasibility_tolerance() const { return control_.feasibility_tolerance; }
  bool stopped() const { return status_ != SearchStatus::kNotRun; }
  int evaluation_count() const { return static_cast<int>(result_.trace.size()); }
  // The index in the trace of the best point so far; -1 if there is none.
  int best() const { return result_.best.value_or(-1); }
  // The free variables and the outcome of one step of the trace.
  Eigen::VectorXd PointOf(int index) const;
  const Evaluation& OutcomeOf(int index) const { return result_.trace[index].outcome; }

  // Returns the result. If a stopping rule has ended the search, its status takes precedence over
  // `status`. Call it once, at the end.
  SearchResult Finish(SearchStatus status, const std::string& message = "");
  // If no variable is free, evaluates the only point and returns the result, as Finish() does.
  std::optional<SearchResult> FinishIfAllFixed();

 private:
  Eigen::VectorXd Whole(const Eigen::VectorXd& free_x) const;  // adds the fixed variables
  SearchStep Evaluate(Eigen::VectorXd x);
  bool IsBetter(const Evaluation& outcome) const;

  SearchProblem problem_;
  SearchControl control_;
  std::vector<int> free_;
  Eigen::VectorXd lower_, upper_, start_;
  std::unique_ptr<EvaluationLog> log_;
  std::map<std::vector<double>, int> known_;  // full x to the index in the trace
  std::vector<std::unique_ptr<Evaluation>> outcomes_;
  SearchStatus status_ = SearchStatus::kNotRun;
  SearchResult result_;
};

}  // namespace lacuna

#endif  // LACUNA_SEARCH_EVALUATOR_H_
