#include "search/evaluator.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/error.h"
#include "core/hash.h"

namespace lacuna {
namespace {

void AppendBits(const Eigen::VectorXd& numbers, std::string* text) {
  for (int i = 0; i < numbers.size(); ++i) {
    *text += fmt::format("{:016x} ", std::bit_cast<uint64_t>(numbers[i]));
  }
}

// Turns values that are not finite into failures, and gives all failures the same form.
Evaluation Normalised(Evaluation outcome, int constraint_count) {
  if (outcome.value) {
    CHECK_EQ(outcome.constraints.size(), constraint_count);
    if (std::isfinite(*outcome.value) && outcome.constraints.allFinite()) {
      outcome.failure.clear();
      return outcome;
    }
    outcome.failure = "the objective or a constraint is not finite";
  }
  outcome.value.reset();
  outcome.constraints.resize(0);
  std::replace(outcome.failure.begin(), outcome.failure.end(), '\n', ' ');
  return outcome;
}

}  // namespace

Evaluator::Evaluator(const SearchProblem& problem, const SearchControl& control,
                     const std::string& method)
    : problem_(problem), control_(control) {
  const int n = static_cast<int>(problem.start.size());
  CHECK_EQ(problem.lower.size(), n);
  CHECK_EQ(problem.upper.size(), n);
  CHECK(problem.evaluate);
  for (int i = 0; i < n; ++i) {
    CHECK(std::isfinite(problem.start[i]));
    CHECK(problem.lower[i] <= problem.start[i] && problem.start[i] <= problem.upper[i])
        << "the start lies outside the bounds";
    if (problem.lower[i] < problem.upper[i]) free_.push_back(i);
  }
  lower_ = problem.lower(free_);
  upper_ = problem.upper(free_);
  start_ = problem.start(free_);
  if (!control.log.empty()) {
    std::string key =
        fmt::format("{} {} {:a} ", control.log_key, method, control.feasibility_tolerance);
    for (const Eigen::VectorXd* part : {&problem.lower, &problem.upper, &problem.start}) {
      AppendBits(*part, &key);
    }
    log_ = std::make_unique<EvaluationLog>(control.log, key, n, problem.constraint_count);
  }
}

double Evaluator::InitialRadius(double radius) const {
  return std::min(radius, 0.5 * (upper_ - lower_).minCoeff());
}

SearchStep Evaluator::Evaluate(Eigen::VectorXd x) {
  const int index = evaluation_count();
  if (log_ && index < static_cast<int>(log_->steps().size())) {
    const SearchStep& step = log_->steps()[index];
    if (step.x != x) {
      throw InputError({control_.log.string(), index + 2},
                       "the search does not evaluate this point; the log was probably written by "
                       "another version of the program, or on a processor with other vector "
                       "instructions; remove this file, and the search starts again");
    }
    return step;
  }
  SearchStep step;
  step.outcome = Normalised(problem_.evaluate(x), m());
  step.x = std::move(x);
  if (log_) log_->Append(step);
  return step;
}

bool Evaluator::IsBetter(const Evaluation& outcome) const {
  if (!outcome.value) return false;
  if (!result_.best) return true;
  const Evaluation& best = OutcomeOf(*result_.best);
  const double excess = std::max(Violation(outcome.constraints), control_.feasibility_tolerance);
  const double best_excess = std::max(Violation(best.constraints), control_.feasibility_tolerance);
  return excess < best_excess || (excess == best_excess && *outcome.value < *best.value);
}

Eigen::VectorXd Evaluator::Whole(const Eigen::VectorXd& free_x) const {
  Eigen::VectorXd x = problem_.start;
  for (int i = 0; i < n(); ++i) {
    CHECK(lower_[i] <= free_x[i] && free_x[i] <= upper_[i])
        << "a search requested a point outside the bounds";
    x[free_[i]] = free_x[i] + 0.0;  // -0 becomes +0
  }
  return x;
}

Eigen::VectorXd Evaluator::GradientAt(const Eigen::VectorXd& x) const {
  if (!problem_.gradient)
    return Eigen::VectorXd::Constant(n(), std::numeric_limits<double>::quiet_NaN());
  return problem_.gradient(Whole(x))(free_);
}

const Evaluation* Evaluator::At(const Eigen::VectorXd& free_x) {
  if (stopped()) return nullptr;
  Eigen::VectorXd x = Whole(free_x);
  const std::vector<double> key(x.data(), x.data() + x.size());
  const auto known = known_.find(key);
  if (known != known_.end()) return outcomes_[known->second].get();
  if (evaluation_count() >= control_.max_evaluations) {
    status_ = SearchStatus::kEvaluations;
    return nullptr;
  }
  SearchStep step = Evaluate(std::move(x));
  if (!step.outcome.value) ++result_.failures;
  known_.emplace(key, evaluation_count());
  outcomes_.push_back(std::make_unique<Evaluation>(step.outcome));
  const bool is_better = IsBetter(step.outcome);
  result_.trace.push_back(std::move(step));
  if (is_better) result_.best = evaluation_count() - 1;
  return outcomes_.back().get();
}

Eigen::VectorXd Evaluator::PointOf(int index) const { return result_.trace[index].x(free_); }

SearchResult Evaluator::Finish(SearchStatus status, const std::string& message) {
  result_.status = status;
  if (evaluation_count() > 0 && !result_.best) result_.status = SearchStatus::kNoValue;
  if (stopped()) result_.status = status_;
  result_.message = message.empty() ? ToString(result_.status) : message;
  std::string bits;
  for (const SearchStep& step : result_.trace) {
    AppendBits(step.x, &bits);
    if (step.outcome.value) AppendBits(Eigen::VectorXd::Constant(1, *step.outcome.value), &bits);
    AppendBits(step.outcome.constraints, &bits);
    bits += "\n";
  }
  result_.trace_hash = HashBytes(bits);
  return std::move(result_);
}

std::optional<SearchResult> Evaluator::FinishIfAllFixed() {
  if (n() > 0) return std::nullopt;
  At(start_);
  return Finish(SearchStatus::kAllFixed);
}

}  // namespace lacuna
