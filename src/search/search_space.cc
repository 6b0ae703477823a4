#include "search/search_space.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lacuna {

SearchSpace::SearchSpace(std::vector<SearchVariable> variables) : variables_(std::move(variables)) {
  for (const SearchVariable& variable : variables_) {
    CHECK(std::isfinite(variable.lower) && std::isfinite(variable.upper)) << variable.name;
    CHECK(variable.lower <= variable.start && variable.start <= variable.upper) << variable.name;
    CHECK(variable.scale == SearchScale::kLinear || variable.lower > 0) << variable.name;
  }
}

Eigen::VectorXd SearchSpace::ToUnit(const Eigen::VectorXd& x) const {
  Eigen::VectorXd u(x.size());
  for (int i = 0; i < x.size(); ++i) {
    const SearchVariable& variable = variables_[i];
    if (variable.lower == variable.upper) {
      u[i] = 0;
    } else if (variable.scale == SearchScale::kLinear) {
      u[i] = (x[i] - variable.lower) / (variable.upper - variable.lower);
    } else {
      u[i] = std::log(x[i] / variable.lower) / std::log(variable.upper / variable.lower);
    }
    u[i] = std::clamp(u[i], 0.0, 1.0);
  }
  return u;
}

Eigen::VectorXd SearchSpace::FromUnit(const Eigen::VectorXd& u) const {
  Eigen::VectorXd x(u.size());
  for (int i = 0; i < u.size(); ++i) {
    const SearchVariable& variable = variables_[i];
    if (u[i] >= 1) {
      x[i] = variable.upper;
    } else if (variable.scale == SearchScale::kLinear) {
      x[i] = variable.lower + u[i] * (variable.upper - variable.lower);
    } else {
      x[i] = variable.lower * std::pow(variable.upper / variable.lower, u[i]);
    }
    x[i] = std::clamp(x[i], variable.lower, variable.upper);
  }
  return x;
}

Eigen::VectorXd SearchSpace::SlopeAt(const Eigen::VectorXd& u) const {
  Eigen::VectorXd slope = FromUnit(u);
  for (int i = 0; i < u.size(); ++i) {
    const SearchVariable& variable = variables_[i];
    const double range = variable.upper - variable.lower;
    slope[i] = variable.scale == SearchScale::kLinear || range == 0
                   ? range
                   : slope[i] * std::log(variable.upper / variable.lower);
  }
  return slope;
}

SearchProblem SearchSpace::ProblemOf(
    std::function<Evaluation(const Eigen::VectorXd& x)> evaluate, int constraint_count,
    std::function<Eigen::VectorXd(const Eigen::VectorXd& x)> gradient) const {
  const int n = static_cast<int>(variables_.size());
  SearchProblem problem;
  Eigen::VectorXd start(n);
  problem.lower = Eigen::VectorXd::Zero(n);
  problem.upper = Eigen::VectorXd::Ones(n);
  for (int i = 0; i < n; ++i) {
    start[i] = variables_[i].start;
    if (variables_[i].lower == variables_[i].upper) problem.upper[i] = 0;
  }
  problem.start = ToUnit(start);
  problem.constraint_count = constraint_count;
  problem.evaluate = [space = *this, evaluate = std::move(evaluate)](const Eigen::VectorXd& u) {
    return evaluate(space.FromUnit(u));
  };
  if (gradient) {
    problem.gradient = [space = *this, gradient = std::move(gradient)](const Eigen::VectorXd& u) {
      return Eigen::VectorXd(gradient(space.FromUnit(u)).cwiseProduct(space.SlopeAt(u)));
    };
  }
  return problem;
}

}  // namespace lacuna
