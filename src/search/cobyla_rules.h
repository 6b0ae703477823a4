// One descent of COBYLA from one starting point, with either set of rules (cobyla.h): those of
// Powell 1994 in powell_rules.cc, the modern ones in modern_rules.cc.
#ifndef LACUNA_SEARCH_COBYLA_RULES_H_
#define LACUNA_SEARCH_COBYLA_RULES_H_

#include <Eigen/Core>

#include "search/evaluator.h"

namespace lacuna {

struct Descent {
  Eigen::VectorXd start;  // n, the free variables only
  double initial_radius = 0;
  double side = 1;  // 1 if the first vertices lie above the start, -1 if they lie below it
  double final_radius = 0;
  int max_iterations = 0;  // limit on trust-region and geometry steps together
};

// The rules of Powell 1994: a single radius ρ, which never grows. All evaluations are made and
// recorded by `evaluator`.
SearchStatus DescendByPowellRules(const Descent& descent, Evaluator* evaluator);

// The modern rules: a trust radius Δ, adapted to the success of the steps, above a resolution ρ.
SearchStatus DescendByModernRules(const Descent& descent, Evaluator* evaluator);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_COBYLA_RULES_H_
