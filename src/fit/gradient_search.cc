#include "fit/gradient_search.h"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>
#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <utility>

#include "search/evaluator.h"

namespace lacuna {
namespace {

using Eigen::VectorXd;

// The least distance of a start from a bound, as a fraction of the range.
constexpr double kMargin = 1e-3;

// The objective as a function of the angles, scaled so that the first step of Ceres has the
// requested length. An exception of the objective is stored here until Ceres has returned.
class OverAngles : public ceres::FirstOrderFunction {
 public:
  OverAngles(Evaluator* evaluator, const GradientSearchOptions& options)
      : evaluator_(*evaluator),
        options_(options),
        range_(evaluator->upper() - evaluator->lower()) {}

  int NumParameters() const override { return evaluator_.n(); }

  VectorXd Start() const {
    const VectorXd share = (evaluator_.start() - evaluator_.lower())
                               .cwiseQuotient(range_)
                               .cwiseMax(kMargin)
                               .cwiseMin(1 - kMargin);
    return (1 - 2 * share.array()).acos();
  }

  bool Evaluate(const double* angles, double* value, double* gradient) const override {
    if (problem_) return false;
    try {
      const VectorXd t = Eigen::Map<const VectorXd>(angles, NumParameters());
      if (!t.allFinite()) return false;
      const VectorXd x = PointAt(t);
      const Evaluation* outcome = evaluator_.At(x);
      if (outcome == nullptr || !outcome->value) return false;
      if (gradient == nullptr) {
        *value = scale_ * *outcome->value;
        return true;
      }
      VectorXd slope;
      if (!Differentiate(x, *outcome->value, &slope)) return false;
      slope = slope.array() * 0.5 * range_.array() * t.array().sin();
      if (scale_ == 0) {
        // In mid-range dx/dt is half of the range.
        const double steepest = slope.norm();
        scale_ = steepest > 0 ? 2 * options_.initial_radius / steepest : 1;
      }
      *value = scale_ * *outcome->value;
      Eigen::Map<VectorXd>(gradient, NumParameters()) = scale_ * slope;
      return true;
    } catch (...) {
      problem_ = std::current_exception();
      return false;
    }
  }

  const std::exception_ptr& problem() const { return problem_; }
  int gradients() const { return gradients_; }
  int differences() const { return differences_; }

 private:
  VectorXd PointAt(const VectorXd& t) const {
    const VectorXd x = evaluator_.lower().array() + range_.array() * 0.5 * (1 - t.array().cos());
    return evaluator_.Within(x);
  }

  bool Differentiate(const VectorXd& x, double value, VectorXd* slope) const {
    *slope = evaluator_.GradientAt(x);
    ++gradients_;
    for (int i = 0; i < x.size(); ++i) {
      if (std::isfinite((*slope)[i])) continue;
      ++differences_;
      VectorXd at[2] = {x, x};
      const double step = options_.difference * range_[i];
      at[0][i] = std::max(x[i] - step, evaluator_.lower()[i]);
      at[1][i] = std::min(x[i] + step, evaluator_.upper()[i]);
      double found[2] = {value, value};
      for (int side = 0; side < 2; ++side) {
        const Evaluation* outcome = evaluator_.At(at[side]);
        if (outcome == nullptr) return false;
        if (outcome->value) {
          found[side] = *outcome->value;
        } else {
          at[side] = x;
        }
      }
      const double width = at[1][i] - at[0][i];
      if (width <= 0) return false;
      (*slope)[i] = (found[1] - found[0]) / width;
    }
    return true;
  }

  Evaluator& evaluator_;
  const GradientSearchOptions& options_;
  VectorXd range_;
  mutable double scale_ = 0;
  mutable int gradients_ = 0, differences_ = 0;
  mutable std::exception_ptr problem_;
};

}  // namespace

SearchResult MinimiseByGradient(const SearchProblem& problem, const SearchControl& control,
                                const GradientSearchOptions& options) {
  CHECK_EQ(problem.constraint_count, 0);
  CHECK_GT(options.initial_radius, 0);
  CHECK_GT(options.final_radius, 0);
  CHECK_GT(options.difference, 0);
  Evaluator evaluator(problem, control,
                      fmt::format("gradient {:a} {:a} {:a}", options.initial_radius,
                                  options.final_radius, options.difference));
  if (std::optional<SearchResult> only = evaluator.FinishIfAllFixed()) return *std::move(only);
  CHECK(evaluator.lower().allFinite() && evaluator.upper().allFinite());
  auto* function = new OverAngles(&evaluator, options);
  const ceres::GradientProblem angles(function);  // owns the function
  ceres::GradientProblemSolver::Options solver;
  solver.line_search_direction_type = ceres::BFGS;
  solver.max_num_iterations = control.max_evaluations;
  solver.parameter_tolerance = options.final_radius;
  solver.logging_type = ceres::SILENT;
  ceres::GradientProblemSolver::Summary summary;
  VectorXd t = function->Start();
  ceres::Solve(solver, angles, t.data(), &summary);
  if (function->problem()) std::rethrow_exception(function->problem());
  return evaluator.Finish(
      summary.termination_type == ceres::CONVERGENCE ? SearchStatus::kConverged
                                                     : SearchStatus::kLibrary,
      fmt::format("{} gradients, {} derivatives by differences; Ceres: {}", function->gradients(),
                  function->differences(), summary.message));
}

}  // namespace lacuna
