// One descent of COBYLA from one starting point, with either set of rules (cobyla.h).
#ifndef LACUNA_SEARCH_COBYLA_RULES_H_
#define LACUNA_SEARCH_COBYLA_RULES_H_

#include <Eigen/Core>

#include "search/evaluator.h"

namespace lacuna {

struct Descent {
  Eigen::VectorXd start;  // free variables
  double initial_radius = 0;
  double side = 1;  // 1 or -1: whether the first vertices lie above or below the start
  double final_radius = 0;
  int max_iterations = 0;  // limit on trust-region and geometry steps together
};

// The rules of Powell 1994: a single radius ρ, which never grows. Evaluates only through
// `evaluator`, which also holds the results.
SearchStatus DescendByPowellRules(const Descent& descent, Evaluator* evaluator);

// The modern rules: a trust radius Δ, adapted to the success of the steps, above a resolution ρ.
SearchStatus DescendByModernRules(const Descent& descent, Evaluator* evaluator);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_COBYLA_RULES_H_
