#include <algorithm>
#include <cmath>
#include <limits>

#include "search/cobyla_rules.h"
#include "search/ordered_algebra.h"
#include "search/simplex.h"

namespace lacuna {
namespace {

using Eigen::VectorXd;

constexpr double kShortStep = 0.1;  // a step below this multiple of the resolution is short
constexpr double kPoorRatio = 0.1;  // actual over predicted reduction below which Δ shrinks
constexpr double kGoodRatio = 0.7;  // the same ratio above which Δ may grow
constexpr double kSnap = 1.5;       // Δ below this multiple of the resolution is set equal to it
constexpr double kGeometryStep = 0.5;  // length of a geometry step as a multiple of Δ
constexpr double kLongEdge = 2;  // a vertex farther from the pole than this multiple of Δ is moved

// The next resolution: a tenth of the present one while it is far from the final radius, and then
// such that it reaches the final radius in two steps.
double NextResolution(double rho, double final_radius) {
  const double ratio = rho / final_radius;
  if (ratio > 250) return 0.1 * rho;
  return ratio <= 16 ? final_radius : std::sqrt(ratio) * final_radius;
}

class ModernDescent {
 public:
  ModernDescent(const Descent& descent, Simplex simplex, Evaluator* evaluator)
      : descent_(descent),
        simplex_(std::move(simplex)),
        evaluator_(*evaluator),
        rho_(descent.initial_radius),
        delta_(descent.initial_radius) {
    penalty_ = std::clamp(simplex_.PenaltyLimit(), kLeastPenalty, 1e3);
  }

  SearchStatus Run() {
    for (int iteration = 0; iteration < descent_.max_iterations; ++iteration) {
      if (!RaisePenalty()) return SearchStatus::kRounding;
      const bool is_spread = IsSpread();
      const bool is_poor = !TryStep();
      if (evaluator_.stopped()) return SearchStatus::kEvaluations;
      if (!is_poor) continue;
      if (!is_spread) {
        if (!simplex_.MovePole(penalty_)) return SearchStatus::kRounding;
        if (!IsSpread() && simplex_.ReplaceByGeometryPoint(FarthestVertex(), kGeometryStep * delta_,
                                                           penalty_, &evaluator_)) {
          continue;
        }
        if (evaluator_.stopped()) return SearchStatus::kEvaluations;
      }
      if (std::max(delta_, last_length_) > rho_) continue;
      if (rho_ <= descent_.final_radius) {
        TakeLastStep();
        return SearchStatus::kConverged;
      }
      const double next = NextResolution(rho_, descent_.final_radius);
      delta_ = std::max(0.5 * rho_, next);
      rho_ = next;
      penalty_ = std::max(kLeastPenalty, std::min(penalty_, simplex_.PenaltyLimit()));
    }
    return SearchStatus::kIterationLimit;
  }

 private:
  static constexpr double kLeastPenalty = std::numeric_limits<double>::epsilon();

  bool IsSpread() const {
    for (int j = 0; j < simplex_.n(); ++j) {
      if (ClearlyGreater(simplex_.EdgeLength(j), kLongEdge * delta_)) return false;
    }
    return true;
  }

  // Solves the trust-region problem at the best vertex and raises the penalty until the solution
  // reduces the merit. A larger penalty may change the best vertex, at most n + 1 times. Returns
  // false if the simplex is degenerate.
  bool RaisePenalty() {
    for (int round = 0; round <= simplex_.n() + 1; ++round) {
      if (!simplex_.MovePole(penalty_)) return false;
      const VectorXd pole = simplex_.Vertex(simplex_.pole());
      const LinearInterpolant& model = simplex_.model();
      trial_ =
          SolveTrustRegion(model, evaluator_.lower() - pole, evaluator_.upper() - pole, delta_);
      violation_reduction_ =
          Violation(model.constraints) -
          Violation(model.constraints + OrderedProduct(model.jacobian, trial_.step));
      value_reduction_ = -OrderedDot(model.gradient, trial_.step);
      if (!(violation_reduction_ > 0 && value_reduction_ < 0)) return true;
      const double needed = -value_reduction_ / violation_reduction_;
      if (penalty_ >= 1.5 * needed) return true;
      penalty_ = 2 * needed;
    }
    return true;
  }

  // Evaluates the trial step. Returns false if it is too short, fails, brings no reduction, or
  // cannot replace a vertex.
  bool TryStep() {
    const VectorXd pole = simplex_.Vertex(simplex_.pole());
    last_length_ = std::min(delta_, OrderedNorm(trial_.step));
    const double expected = value_reduction_ + penalty_ * violation_reduction_;
    is_short_ = last_length_ <= kShortStep * rho_;
    if (is_short_ || !(expected > 1e-6 * std::min(penalty_, 1.0) * rho_)) {
      SetDelta(0.1 * delta_);
      return false;
    }
    const VectorXd x = evaluator_.Within(pole + trial_.step);
    const Evaluation* outcome = evaluator_.At(x);
    if (outcome == nullptr) return false;
    if (!outcome->value) {
      SetDelta(0.5 * last_length_);
      return false;
    }
    const double reduction = simplex_.Merit(simplex_.pole(), penalty_) - *outcome->value -
                             penalty_ * Violation(outcome->constraints);
    const double ratio = reduction / expected;
    if (ratio <= kPoorRatio) {
      SetDelta(0.5 * last_length_);
    } else if (ratio <= kGoodRatio) {
      SetDelta(std::max(0.5 * delta_, last_length_));
    } else {
      SetDelta(std::max(0.5 * delta_, 2 * last_length_));
    }
    const int dropped = VertexToDrop(x - pole, reduction > 0);
    if (dropped < 0) return false;
    simplex_.Replace(dropped, x, *outcome);
    return ratio > 0;
  }

  void SetDelta(double delta) { delta_ = delta <= kSnap * rho_ ? rho_ : delta; }

  int VertexToDrop(const VectorXd& step, bool is_better) const {
    const double unit = std::max(rho_, 0.1 * delta_);
    int dropped = -1;
    double largest = is_better ? 0 : 1;
    double at_pole = 1;
    for (int j = 0; j <= simplex_.n(); ++j) {
      const bool is_pole = j == simplex_.pole();
      if (is_pole && !is_better) continue;
      const double lagrange = is_pole ? at_pole : simplex_.Lagrange(j, step);
      at_pole -= lagrange;
      const VectorXd from = is_pole ? VectorXd::Zero(simplex_.n()) : simplex_.Offset(j);
      const double distance = OrderedNorm(is_better ? VectorXd(from - step) : from) / unit;
      const double score = std::max(1.0, distance * distance) * std::abs(lagrange);
      if (ClearlyGreater(score, largest)) {
        largest = score;
        dropped = j;
      }
    }
    return dropped;
  }

  int FarthestVertex() const {
    int farthest = 0;
    for (int j = 1; j < simplex_.n(); ++j) {
      if (ClearlyGreater(simplex_.EdgeLength(j), simplex_.EdgeLength(farthest))) farthest = j;
    }
    return farthest;
  }

  // Evaluates the last step that was too short to be tried, since it may still be the best point.
  void TakeLastStep() {
    if (!is_short_ || last_length_ <= 1e-3 * rho_) return;
    const VectorXd pole = simplex_.Vertex(simplex_.pole());
    evaluator_.At(evaluator_.Within(pole + trial_.step));
  }

  const Descent& descent_;
  Simplex simplex_;
  Evaluator& evaluator_;
  double rho_, delta_;
  double penalty_ = 0;
  TrustRegionStep trial_;
  double violation_reduction_ = 0, value_reduction_ = 0;
  double last_length_ = 0;
  bool is_short_ = false;
};

}  // namespace

SearchStatus DescendByModernRules(const Descent& descent, Evaluator* evaluator) {
  std::optional<Simplex> simplex =
      Simplex::Around(descent.start, descent.side * descent.initial_radius, evaluator);
  if (!simplex) return evaluator->best() < 0 ? SearchStatus::kNoValue : SearchStatus::kRounding;
  return ModernDescent(descent, *std::move(simplex), evaluator).Run();
}

}  // namespace lacuna
