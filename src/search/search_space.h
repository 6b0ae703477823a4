// The mapping between the variables of a search in SI units and the unit cube in which it runs.
#ifndef LACUNA_SEARCH_SEARCH_SPACE_H_
#define LACUNA_SEARCH_SEARCH_SPACE_H_

#include <functional>
#include <string>
#include <vector>

#include "search/search_problem.h"

namespace lacuna {

enum class SearchScale {
  kLinear,
  kLogarithmic,  // equal steps are equal ratios; for moduli and volumes that range over decades
};

struct SearchVariable {
  std::string name;
  double lower = 0, upper = 1;               // in SI units; equal for a fixed variable
  double start = 0.5;                        // within the bounds
  SearchScale scale = SearchScale::kLinear;  // kLogarithmic requires lower > 0
};

class SearchSpace {
 public:
  // CHECKs that all bounds are finite and satisfy the conditions on SearchVariable.
  explicit SearchSpace(std::vector<SearchVariable> variables);

  const std::vector<SearchVariable>& variables() const { return variables_; }

  // Convert between x (n, SI) and unit coordinates u (n) in [0, 1]:
  //   x = lower + u (upper - lower)     or     x = lower (upper / lower)^u.
  // u = 0 and u = 1 give the bounds exactly, and x never lies outside the bounds.
  Eigen::VectorXd ToUnit(const Eigen::VectorXd& x) const;
  Eigen::VectorXd FromUnit(const Eigen::VectorXd& u) const;

  // dx_i/du_i at u (n); 0 for a fixed variable.
  Eigen::VectorXd SlopeAt(const Eigen::VectorXd& u) const;

  // The search problem in unit coordinates for an objective of x and, optionally, its gradient with
  // respect to x.
  SearchProblem ProblemOf(
      std::function<Evaluation(const Eigen::VectorXd& x)> evaluate, int constraint_count = 0,
      std::function<Eigen::VectorXd(const Eigen::VectorXd& x)> gradient = {}) const;

 private:
  std::vector<SearchVariable> variables_;
};

}  // namespace lacuna

#endif  // LACUNA_SEARCH_SEARCH_SPACE_H_
