#include "search/cobyla.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "search/cobyla_rules.h"
#include "search/evaluator.h"

namespace lacuna {
namespace {

std::string MethodName(const CobylaOptions& options) {
  const CobylaRestarts& restarts = options.restarts;
  return fmt::format("cobyla {} {:a} {:a} {} {:a} {:a} {:a}",
                     options.mode == CobylaMode::kPowell ? "powell" : "modern",
                     options.initial_radius, options.final_radius, restarts.max_restarts,
                     restarts.resolution, restarts.shrink, restarts.min_radius);
}

SearchStatus Descend(CobylaMode mode, const Descent& descent, Evaluator* evaluator) {
  return mode == CobylaMode::kPowell ? DescendByPowellRules(descent, evaluator)
                                     : DescendByModernRules(descent, evaluator);
}

}  // namespace

SearchResult MinimiseByCobyla(const SearchProblem& problem, const SearchControl& control,
                              const CobylaOptions& options) {
  CHECK_GT(options.initial_radius, 0);
  CHECK_GT(options.final_radius, 0);
  Evaluator evaluator(problem, control, MethodName(options));
  if (std::optional<SearchResult> only = evaluator.FinishIfAllFixed()) return *std::move(only);
  Descent descent;
  descent.start = evaluator.start();
  descent.initial_radius = evaluator.InitialRadius(options.initial_radius);
  descent.max_iterations = 1000 + 20 * control.max_evaluations;
  const CobylaRestarts& restarts = options.restarts;
  SearchStatus status = SearchStatus::kNotRun;
  int barren = 0;  // consecutive descents without a new evaluation
  for (int round = 0; round <= restarts.max_restarts && barren < 2; ++round) {
    descent.final_radius = std::max(options.final_radius, 1e-14 * descent.initial_radius);
    if (restarts.max_restarts > 0) {
      descent.final_radius =
          std::max(descent.final_radius, restarts.resolution * descent.initial_radius);
    }
    descent.final_radius = std::min(descent.final_radius, descent.initial_radius);
    const int before = evaluator.evaluation_count();
    status = Descend(options.mode, descent, &evaluator);
    if (evaluator.stopped() || evaluator.best() < 0) break;
    barren = evaluator.evaluation_count() == before ? barren + 1 : 0;
    descent.start = evaluator.PointOf(evaluator.best());
    if (barren > 0) descent.side = -descent.side;
    descent.initial_radius = std::max(restarts.shrink * descent.initial_radius,
                                      std::min(restarts.min_radius, descent.initial_radius));
  }
  return evaluator.Finish(status);
}

}  // namespace lacuna
