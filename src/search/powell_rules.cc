#include <algorithm>
#include <cmath>

#include "search/cobyla_rules.h"
#include "search/ordered_algebra.h"
#include "search/simplex.h"

namespace lacuna {
namespace {

using Eigen::VectorXd;

// The constants of Powell 1994, section 3: α and β of eq. 14, γ of the geometry step, and δ of eq.
// 21.
constexpr double kAlpha = 0.25;
constexpr double kBeta = 2.1;
constexpr double kGamma = 0.5;
constexpr double kDelta = 1.1;

bool IsAcceptable(const Simplex& simplex, double rho) {
  for (int j = 0; j < simplex.n(); ++j) {
    if (ClearlyGreater(kAlpha * rho, simplex.FaceDistance(j)) ||
        ClearlyGreater(simplex.EdgeLength(j), kBeta * rho)) {
      return false;
    }
  }
  return true;
}

// The vertex that a geometry step moves: the one farthest from the pole if it is too far away,
// otherwise the one nearest to its opposite face (eq. 15 and 16).
int VertexToMove(const Simplex& simplex, double rho) {
  int worst = -1;
  for (int j = 0; j < simplex.n(); ++j) {
    const double longest = worst < 0 ? kBeta * rho : simplex.EdgeLength(worst);
    if (ClearlyGreater(simplex.EdgeLength(j), longest)) worst = j;
  }
  if (worst >= 0) return worst;
  worst = 0;
  for (int j = 1; j < simplex.n(); ++j) {
    if (ClearlyGreater(simplex.FaceDistance(worst), simplex.FaceDistance(j))) worst = j;
  }
  return worst;
}

// The vertex that the trial point replaces (eq. 19 to 22); -1 if none. Among equally distant
// vertices, a frequent case for which the paper gives no rule, the one with the lower merit is
// chosen.
int VertexToDrop(const Simplex& simplex, const VectorXd& step, double rho, double penalty,
                 bool is_better) {
  int dropped = -1;
  double largest = is_better ? 0 : 1;
  VectorXd height(simplex.n());
  for (int j = 0; j < simplex.n(); ++j) {
    const double lagrange = std::abs(simplex.Lagrange(j, step));
    if (ClearlyGreater(lagrange, largest)) {
      largest = lagrange;
      dropped = j;
    }
    height[j] = lagrange * simplex.FaceDistance(j);
  }
  double longest = kDelta * rho;
  int farthest = -1;
  for (int j = 0; j < simplex.n(); ++j) {
    if (ClearlyGreater(std::min(kAlpha * rho, simplex.FaceDistance(j)), height[j])) continue;
    const double distance =
        is_better ? OrderedNorm(step - simplex.Offset(j)) : simplex.EdgeLength(j);
    const bool ties = farthest >= 0 && !ClearlyGreater(longest, distance) &&
                      simplex.Merit(j, penalty) < simplex.Merit(farthest, penalty);
    if (ClearlyGreater(distance, longest) || ties) {
      longest = distance;
      farthest = j;
    }
  }
  return farthest >= 0 ? farthest : dropped;
}

// The next radius (section 3, after eq. 16).
double NextRadius(double rho, double final_radius) {
  return 0.5 * rho <= 1.5 * final_radius ? final_radius : 0.5 * rho;
}

struct Prediction {
  double reduction_of_violation = 0;
  double change_of_value = 0;
};

Prediction Predict(const LinearInterpolant& model, const VectorXd& step) {
  const VectorXd constraints = model.constraints + OrderedProduct(model.jacobian, step);
  return {Violation(model.constraints) - Violation(constraints), OrderedDot(model.gradient, step)};
}

enum class Outcome { kGood, kPoor, kShort, kPenaltyRaised, kStopped };

class PowellDescent {
 public:
  PowellDescent(const Descent& descent, Simplex simplex, Evaluator* evaluator)
      : descent_(descent),
        simplex_(std::move(simplex)),
        evaluator_(*evaluator),
        rho_(descent.initial_radius) {}

  SearchStatus Run() {
    bool wants_geometry = false;
    for (int iteration = 0; iteration < descent_.max_iterations; ++iteration) {
      if (!simplex_.MovePole(penalty_)) return SearchStatus::kRounding;
      const bool acceptable = IsAcceptable(simplex_, rho_);
      if (wants_geometry && !acceptable) {
        wants_geometry = false;
        if (simplex_.ReplaceByGeometryPoint(VertexToMove(simplex_, rho_), kGamma * rho_, penalty_,
                                            &evaluator_)) {
          continue;
        }
        if (evaluator_.stopped()) return SearchStatus::kEvaluations;
        if (!Shrink()) return Converged();  // the geometry cannot be improved
        continue;
      }
      wants_geometry = false;
      const Outcome outcome = TryStep();
      if (outcome == Outcome::kStopped) return SearchStatus::kEvaluations;
      if (outcome == Outcome::kGood || outcome == Outcome::kPenaltyRaised) continue;
      if (!acceptable) {
        wants_geometry = true;
      } else if (!Shrink()) {
        return Converged();
      }
    }
    return SearchStatus::kIterationLimit;
  }

 private:
  Outcome TryStep() {
    const LinearInterpolant& model = simplex_.model();
    const VectorXd pole = simplex_.Vertex(simplex_.pole());
    const TrustRegionStep trial =
        SolveTrustRegion(model, evaluator_.lower() - pole, evaluator_.upper() - pole, rho_);
    short_trial_.reset();
    if (!trial.on_boundary && ClearlyGreater(0.5 * rho_, OrderedNorm(trial.step))) {
      short_trial_ = evaluator_.Within(pole + trial.step);
      return Outcome::kShort;
    }
    const Prediction predicted = Predict(model, trial.step);
    if (RaisePenalty(predicted)) return Outcome::kPenaltyRaised;

    const VectorXd x = evaluator_.Within(pole + trial.step);
    const Evaluation* outcome = evaluator_.At(x);
    if (outcome == nullptr) return Outcome::kStopped;
    if (!outcome->value) return Outcome::kPoor;
    const int best = simplex_.pole();
    double expected = penalty_ * predicted.reduction_of_violation - predicted.change_of_value;
    double reduction = simplex_.Merit(best, penalty_) - *outcome->value -
                       penalty_ * Violation(outcome->constraints);
    if (penalty_ == 0 && *outcome->value == simplex_.value(best)) {
      expected = predicted.reduction_of_violation;
      reduction = simplex_.violation(best) - Violation(outcome->constraints);
    }
    const int dropped = VertexToDrop(simplex_, x - pole, rho_, penalty_, reduction > 0);
    if (dropped < 0) return Outcome::kPoor;
    simplex_.Replace(dropped, x, *outcome);
    return reduction > 0 && reduction >= 0.1 * expected ? Outcome::kGood : Outcome::kPoor;
  }

  // Raises the penalty if necessary (section 2, after eq. 9). Returns true if another vertex has
  // become the best one.
  bool RaisePenalty(const Prediction& predicted) {
    const double needed = predicted.reduction_of_violation > 0
                              ? predicted.change_of_value / predicted.reduction_of_violation
                              : 0;
    if (penalty_ >= 1.5 * needed) return false;
    penalty_ = 2 * needed;
    for (int j = 0; j < simplex_.n(); ++j)
      if (simplex_.IsBetter(j, simplex_.pole(), penalty_)) return true;
    return false;
  }

  // If the best vertex is infeasible, evaluates the last step that was too short to be tried,
  // because its end may be feasible. Powell 1994 has no such rule.
  SearchStatus Converged() {
    if (short_trial_ && simplex_.violation(simplex_.pole()) > evaluator_.feasibility_tolerance()) {
      evaluator_.At(*short_trial_);
    }
    return SearchStatus::kConverged;
  }

  bool Shrink() {
    if (rho_ <= descent_.final_radius) return false;
    rho_ = NextRadius(rho_, descent_.final_radius);
    if (penalty_ > 0) penalty_ = std::min(penalty_, simplex_.PenaltyLimit());
    return true;
  }

  const Descent& descent_;
  Simplex simplex_;
  Evaluator& evaluator_;
  double rho_;
  double penalty_ = 0;
  std::optional<VectorXd> short_trial_;  // the latest trial point, if its step was too short
};

}  // namespace

SearchStatus DescendByPowellRules(const Descent& descent, Evaluator* evaluator) {
  std::optional<Simplex> simplex =
      Simplex::Around(descent.start, descent.side * descent.initial_radius, evaluator);
  if (!simplex) return evaluator->best() < 0 ? SearchStatus::kNoValue : SearchStatus::kRounding;
  return PowellDescent(descent, *std::move(simplex), evaluator).Run();
}

}  // namespace lacuna
