#include "search/search_problem.h"

#include <algorithm>

namespace lacuna {

const char* ToString(SearchStatus status) {
  switch (status) {
    case SearchStatus::kNotRun:
      return "not run";
    case SearchStatus::kConverged:
      return "converged";
    case SearchStatus::kEvaluations:
      return "evaluation limit reached";
    case SearchStatus::kRounding:
      return "stopped by rounding errors";
    case SearchStatus::kNoValue:
      return "no evaluation succeeded";
    case SearchStatus::kAllFixed:
      return "no free variables";
    case SearchStatus::kIterationLimit:
      return "iteration limit reached";
    case SearchStatus::kLibrary:
      return "external library failed";
  }
  return "unknown";
}

double Violation(const Eigen::VectorXd& constraints) {
  double violation = 0;
  for (int i = 0; i < constraints.size(); ++i) violation = std::max(violation, -constraints[i]);
  return violation;
}

double SearchResult::violation() const { return Violation(trace[*best].outcome.constraints); }

}  // namespace lacuna
