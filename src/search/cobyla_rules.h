// The two sets of rules of cobyla.h, one descent from one start each.
#ifndef LACUNA_SEARCH_COBYLA_RULES_H_
#define LACUNA_SEARCH_COBYLA_RULES_H_

#include <Eigen/Core>

#include "search/evaluator.h"

namespace lacuna {

struct Descent {
  Eigen::VectorXd start;  // free variables
  double initial_radius = 0;
  double side = 1;  // -1: the first vertices lie on the lower side of the start
  double final_radius = 0;
  int max_iterations = 0;  // cap on trust-region and geometry steps together
};

// Powell 1994: one radius ρ, which is halved and never grows.
SearchStatus DescendByPowellRules(const Descent& descent, Evaluator* evaluator);

// A trust radius Δ that follows the success of the steps above a resolution ρ that falls when no
// better geometry is left to try.
SearchStatus DescendByModernRules(const Descent& descent, Evaluator* evaluator);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_COBYLA_RULES_H_
