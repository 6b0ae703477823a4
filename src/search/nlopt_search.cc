#include "search/nlopt_search.h"

#include <fmt/format.h>
#include <glog/logging.h>
#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include "search/evaluator.h"

namespace lacuna {
namespace {

using Eigen::VectorXd;

// The state shared by NLopt's two callbacks. It stores an exception of the objective until NLopt's
// C code has returned.
class Bridge {
 public:
  Bridge(Evaluator* evaluator, nlopt_opt optimiser)
      : evaluator_(*evaluator), optimiser_(optimiser) {}

  double Value(const double* x) {
    const Evaluation* outcome = At(x);
    if (outcome == nullptr) return worst_;
    if (!outcome->value) return worst_ + (worst_ - best_) + (any_ ? 1e-3 * std::abs(worst_) : 1);
    worst_ = any_ ? std::max(worst_, *outcome->value) : *outcome->value;
    best_ = any_ ? std::min(best_, *outcome->value) : *outcome->value;
    any_ = true;
    return *outcome->value;
  }

  // NLopt considers a constraint feasible where it is <= 0, so the sign is reversed.
  void Constraints(const double* x, double* result) {
    const Evaluation* outcome = At(x);
    for (int i = 0; i < evaluator_.m(); ++i) {
      result[i] = outcome && outcome->value ? -outcome->constraints[i] : 0;
    }
  }

  const std::exception_ptr& problem() const { return problem_; }

 private:
  const Evaluation* At(const double* x) {
    const int before = evaluator_.evaluation_count();
    const Evaluation* outcome = nullptr;
    try {
      const VectorXd asked = Eigen::Map<const VectorXd>(x, evaluator_.n());
      if (!problem_ && asked.allFinite()) {
        outcome = evaluator_.At(evaluator_.Within(asked));
      }
    } catch (...) {
      problem_ = std::current_exception();
    }
    repeats_ = evaluator_.evaluation_count() == before ? repeats_ + 1 : 0;
    if (outcome == nullptr || repeats_ > kMostRepeats) nlopt_force_stop(optimiser_);
    return outcome;
  }

  static constexpr int kMostRepeats = 1000;

  Evaluator& evaluator_;
  nlopt_opt optimiser_;
  bool any_ = false;
  double best_ = 0, worst_ = 0;
  int repeats_ = 0;
  std::exception_ptr problem_;
};

double ValueCallback(unsigned, const double* x, double*, void* bridge) {
  return static_cast<Bridge*>(bridge)->Value(x);
}

void ConstraintCallback(unsigned, double* result, unsigned, const double* x, double*,
                        void* bridge) {
  static_cast<Bridge*>(bridge)->Constraints(x, result);
}

}  // namespace

SearchResult MinimiseByNlopt(const SearchProblem& problem, const SearchControl& control,
                             const NloptOptions& options) {
  const bool is_cobyla = options.algorithm == NloptAlgorithm::kCobyla;
  CHECK(is_cobyla || problem.constraint_count == 0);
  Evaluator evaluator(problem, control,
                      fmt::format("nlopt {} {:a} {:a}", is_cobyla ? "cobyla" : "bobyqa",
                                  options.initial_radius, options.final_radius));
  if (std::optional<SearchResult> only = evaluator.FinishIfAllFixed()) return *std::move(only);
  CHECK(is_cobyla || evaluator.n() >= 2);
  const std::unique_ptr<std::remove_pointer_t<nlopt_opt>, void (*)(nlopt_opt)> optimiser(
      nlopt_create(is_cobyla ? NLOPT_LN_COBYLA : NLOPT_LN_BOBYQA, evaluator.n()), nlopt_destroy);
  CHECK(optimiser);
  Bridge bridge(&evaluator, optimiser.get());
  nlopt_set_min_objective(optimiser.get(), ValueCallback, &bridge);
  nlopt_set_lower_bounds(optimiser.get(), evaluator.lower().data());
  nlopt_set_upper_bounds(optimiser.get(), evaluator.upper().data());
  const VectorXd tolerances = VectorXd::Zero(evaluator.m());
  if (evaluator.m() > 0) {
    nlopt_add_inequality_mconstraint(optimiser.get(), evaluator.m(), ConstraintCallback, &bridge,
                                     tolerances.data());
  }
  const double radius = evaluator.InitialRadius(options.initial_radius);
  nlopt_set_initial_step1(optimiser.get(), radius);
  // Both algorithms apply this tolerance relative to the initial radius, not to x.
  nlopt_set_xtol_rel(optimiser.get(), options.final_radius / radius);
  VectorXd x = evaluator.start();
  double value = 0;
  const nlopt_result outcome = nlopt_optimize(optimiser.get(), x.data(), &value);
  if (bridge.problem()) std::rethrow_exception(bridge.problem());
  if (evaluator.stopped()) return evaluator.Finish(SearchStatus::kNotRun);
  return evaluator.Finish(outcome > 0 ? SearchStatus::kConverged : SearchStatus::kLibrary,
                          fmt::format("NLopt: {}", nlopt_result_to_string(outcome)));
}

}  // namespace lacuna
