#include "fem/newton.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fem/kept_factor_iteration.h"
#include "fem/largest_entry.h"
#include "fem/node_rotations.h"
#include "fem/unsymmetric_factor.h"

namespace lacuna {
namespace {

class Newton {
 public:
  Newton(const NewtonProblem& problem, LinearSolver* solver, BlockMatrix* tangent)
      : problem_(problem), solver_(*solver), tangent_(*tangent) {}

  NewtonSummary Run(const Eigen::VectorXd& target, Eigen::VectorXd* position) {
    NewtonIterate at;
    if (std::optional<NewtonIterate> found = IterateWithKeptFactor(
            problem_, target, *position, &solver_, &tangent_, &summary_.iterations)) {
      at = *std::move(found);
      summary_.status = NewtonSummary::Status::kConverged;
    } else {
      at = EvaluateIterate(problem_, *position);
      if (MoveHeld(target, &at) && Iterate(&at))
        summary_.status = NewtonSummary::Status::kConverged;
    }
    *position = at.position;
    Eigen::Index worst = 0;
    summary_.residual = at.residual.size() > 0 ? at.residual.cwiseAbs().maxCoeff(&worst) : 0;
    if (!summary_.IsUsable()) {
      summary_.message +=
          fmt::format("; largest residual {:.3g} N at node {}", summary_.residual, worst / 3);
    }
    return summary_;
  }

 private:
  // Iterates to the solution. Returns false, with status and message, if that is not found.
  bool Iterate(NewtonIterate* at) {
    while (!IsConverged(*at)) {
      if (summary_.iterations >= problem_.max_iterations) {
        return Fail(NewtonSummary::Status::kNoConvergence,
                    fmt::format("no convergence in {} iterations", summary_.iterations));
      }
      ++summary_.iterations;
      if (!Advance(at)) return false;
    }
    return true;
  }

  NewtonIterate Evaluate(const Eigen::VectorXd& position) const {
    return EvaluateIterate(problem_, position);
  }

  double Potential(NewtonIterate* at) const {
    if (!at->potential) {
      at->potential =
          problem_.equation.Potential(at->position) - problem_.applied_force.dot(at->position);
    }
    return *at->potential;
  }

  bool IsConverged(const NewtonIterate& at) const {
    return IsWithinTolerance(problem_, at) ||
           (std::isfinite(rounding_) && std::isfinite(at.force_scale) &&
            at.residual.norm() <= rounding_);
  }

  void AssembleTangent(const NewtonIterate& at) {
    problem_.equation.Tangent(at.position, convexify_, &tangent_);
    // Positions are rounded to ε |x|, and therefore forces to about ε |x| times the largest
    // stiffness. The smallest of these bounds over all iterates is used.
    double stiffest = 0;
    for (const int k : tangent_.pattern().diagonal) {
      stiffest = std::max(stiffest, tangent_.Block(k).diagonal().maxCoeff());
    }
    rounding_ = std::min(rounding_, 4 * std::numeric_limits<double>::epsilon() * stiffest *
                                        at.position.lpNorm<Eigen::Infinity>() *
                                        std::sqrt(static_cast<double>(at.position.size())));
  }

  // The solution of tangent · step = right() with the exact tangent or, if that is not positive
  // definite, with its convexified approximation. right() may use the assembled tangent. No value,
  // and the reason in `*why`, if there is none.
  template <typename RightHandSide>
  std::optional<Eigen::VectorXd> SolveLinearised(const NewtonIterate& at,
                                                 const RightHandSide& right, std::string* why) {
    LinearSolveSummary solved;
    Eigen::VectorXd step;
    rotations_ = NodeRotations(problem_.equation.body(), at.position);
    for (int attempt = 0; attempt < 2; ++attempt) {
      AssembleTangent(at);
      const Eigen::VectorXd b = right();
      solved = solver_.Solve(tangent_, b, &step, &rotations_);
      const bool is_descent = solved.IsUsable() && step.allFinite() && step.dot(b) >= 0;
      has_tangent_ = is_descent && !convexify_;
      if (is_descent) return step;
      if (convexify_) break;
      convexify_ = true;
    }
    *why = fmt::format("the linearised step could not be solved: {}", solved.message);
    return std::nullopt;
  }

  // Tries a step with the tangent of an earlier iterate (the chord method). Near the solution this
  // is nearly as effective as a new tangent, whose assembly costs more than a step. Returns false
  // and leaves `at` unchanged if the residual does not decrease enough.
  bool FollowChord(NewtonIterate* at) {
    constexpr double kSufficientRatio = 0.2;  // largest ratio of the new residual to the old one
    if (!has_tangent_ || convexify_) return false;
    has_tangent_ = false;
    Eigen::VectorXd step;
    const LinearSolveSummary solved = solver_.Solve(tangent_, -at->residual, &step, &rotations_);
    if (!solved.IsUsable() || !step.allFinite()) return false;
    NewtonIterate next = Evaluate(at->position + step);
    if (!(next.residual.norm() / at->residual.norm() <= kSufficientRatio)) return false;
    has_tangent_ = true;
    slow_steps_ = 0;
    *at = std::move(next);
    return true;
  }

  std::optional<Eigen::VectorXd> NewtonStep(const NewtonIterate& at, std::string* why) {
    return SolveLinearised(
        at, [&] { return Eigen::VectorXd(-at.residual); }, why);
  }

  // Moves the held components to those of `target`, and the others as the linearised equation
  // demands. Returns false, with status and message, if that cannot be solved.
  bool MoveHeld(const Eigen::VectorXd& target, NewtonIterate* at) {
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(target.size());
    problem_.held.Copy(target - at->position, &motion);
    if (motion.isZero(0)) return true;
    Eigen::VectorXd step = Eigen::VectorXd::Zero(target.size());
    if (!problem_.held.HoldsAll()) {
      ++summary_.iterations;
      const auto right = [&] {
        Eigen::VectorXd b;
        tangent_.Multiply(motion, &b);
        b = -(b + at->residual);
        problem_.held.ClearIn(b);
        return b;
      };
      std::string why;
      std::optional<Eigen::VectorXd> solved = SolveLinearised(*at, right, &why);
      if (!solved) return Fail(NewtonSummary::Status::kLinearSolverFailed, why);
      step = *std::move(solved);
    }
    *at = Evaluate(WithHeldAt(problem_, target, at->position + step + motion));
    convexify_ = false;
    return true;
  }

  // Performs one iteration. The potential of a nearly incompressible or rotating body has a narrow
  // curved valley. A full step along its tangent leads up the side of the valley, and the next full
  // step leads back to its bottom far ahead, whereas a line search would make little progress. An
  // increase is therefore accepted if the following full step ends below the start (the watchdog
  // technique, Chamberlain et al. 1982). Returns false, with status and message, if no step is
  // found.
  bool Advance(NewtonIterate* at) {
    if (needs_skew_ && AdvanceByWholeTangent(at)) return true;
    if (FollowChord(at)) return true;
    std::string why;
    const std::optional<Eigen::VectorXd> step = NewtonStep(*at, &why);
    if (!step) return Fail(NewtonSummary::Status::kLinearSolverFailed, why);
    NewtonIterate full = Evaluate(at->position + *step);
    const double slope = at->residual.dot(*step);
    const double work = Work(*at, full, *step);
    const bool falls = Falls(at, &full, slope, work);
    if (IsSlow(*at, full) && falls && AdvanceByWholeTangent(at)) return true;
    if (falls) {
      *at = std::move(full);
      // Near the solution the exact tangent is definite and converges quadratically.
      convexify_ = false;
      may_climb_ = true;
      return true;
    }
    if (may_climb_) {
      if (std::optional<NewtonIterate> beyond = StepBelow(at, slope, work, full)) {
        *at = *std::move(beyond);
        convexify_ = false;
        return true;
      }
    }
    if (AdvanceByWholeTangent(at)) return true;
    may_climb_ = false;
    if (SearchLine(at, *step, slope, full)) return true;
    return Fail(NewtonSummary::Status::kNoConvergence, "no descent along the Newton direction");
  }

  // Whether several steps in succession, of which this is the last, have hardly reduced the
  // residual. Where the tangent has a skew-symmetric part, which a Newton step leaves out, steps
  // converge linearly at best, and not at all where a load that turns with the body bends it far.
  bool IsSlow(const NewtonIterate& from, const NewtonIterate& to) {
    // Smaller: the whole tangent is factorised more often.
    constexpr int kMostSlow = 3;
    slow_steps_ = to.residual.norm() > kSlow * from.residual.norm() ? slow_steps_ + 1 : 0;
    return slow_steps_ >= kMostSlow;
  }

  // The step of the whole tangent. No value where the skew-symmetric part is negligible, where the
  // tangent is singular or too large for an LU factor, and where the step leads uphill on the
  // symmetric part, as it may near an unstable equilibrium.
  std::optional<Eigen::VectorXd> WholeStep(const NewtonIterate& at) const {
    constexpr Eigen::Index kMostComponents = 60'000;  // larger: a factor of several GB
    constexpr double kNegligible = 1e-6;              // relative to the symmetric part
    if (at.position.size() > kMostComponents) return std::nullopt;
    BlockMatrix skew(tangent_.shared_pattern());
    if (!problem_.equation.SkewTangent(at.position, &skew)) return std::nullopt;
    BlockMatrix symmetric(tangent_.shared_pattern());
    problem_.equation.Tangent(at.position, /*convexify=*/false, &symmetric);
    if (LargestEntry(skew) <= kNegligible * LargestEntry(symmetric)) return std::nullopt;
    const UnsymmetricFactor whole(problem_.held, symmetric, &skew);
    if (!whole.IsUsable()) return std::nullopt;
    Eigen::VectorXd step = whole.Solve(-at.residual);
    if (!step.allFinite() || step.dot(at.residual) >= 0) return std::nullopt;
    return step;
  }

  // An iteration with the whole tangent, whose steps reduce the norm of the residual if they are
  // short enough. As in Advance(), a full step may increase it if the next one more than makes up
  // for that. If there is no such step, returns false, leaves `at` unchanged, and the whole tangent
  // is not tried again.
  bool AdvanceByWholeTangent(NewtonIterate* at) {
    constexpr double kShortest = 1.0 / 64;  // length of a step; smaller values give up later
    if (whole_fails_) return false;
    whole_fails_ = true;
    const double before = at->residual.norm();
    const auto is_sufficient = [&](const NewtonIterate& to, double length) {
      return to.residual.norm() <= (1 - kSufficient * length) * before;  // false for NaN
    };
    const std::optional<Eigen::VectorXd> step = WholeStep(*at);
    if (!step) return false;
    NewtonIterate trial = Evaluate(at->position + *step);
    if (!is_sufficient(trial, 1) && trial.residual.allFinite() &&
        summary_.iterations < problem_.max_iterations) {
      ++summary_.iterations;
      if (const std::optional<Eigen::VectorXd> next = WholeStep(trial))
        trial = Evaluate(trial.position + *next);
    }
    double length = 1;
    while (!is_sufficient(trial, length)) {
      length /= 2;
      if (length < kShortest) return false;
      trial = Evaluate(at->position + length * *step);
    }
    needs_skew_ = length == 1 && trial.residual.norm() <= kSlow * before;
    *at = std::move(trial);
    whole_fails_ = convexify_ = has_tangent_ = false;
    may_climb_ = true;
    return true;
  }

  // Takes another full step from `full`, where the potential exceeds that of `start`. No value
  // unless there is such a step and the potential at its end is below that of `start`. `slope` and
  // `work` are the change of the potential to first order and the work of the residual from `start`
  // to `full`, J.
  std::optional<NewtonIterate> StepBelow(NewtonIterate* start, double slope, double work,
                                         const NewtonIterate& full) {
    if (!full.residual.allFinite() || summary_.iterations >= problem_.max_iterations)
      return std::nullopt;
    ++summary_.iterations;
    std::string why;
    const std::optional<Eigen::VectorXd> step = NewtonStep(full, &why);
    if (!step) return std::nullopt;  // a line search from `start` follows
    NewtonIterate beyond = Evaluate(full.position + *step);
    if (!Falls(start, &beyond, slope, work + Work(full, beyond, *step))) return std::nullopt;
    return beyond;
  }

  // The work of the residual along a step by the trapezoidal rule, J. It equals the change of the
  // potential to second order and replaces it if there is no potential.
  static double Work(const NewtonIterate& from, const NewtonIterate& to,
                     const Eigen::VectorXd& step) {
    return 0.5 * (from.residual.dot(step) + to.residual.dot(step));
  }

  // Whether the potential decreases sufficiently (Armijo 1966) from one iterate to another.
  // `expected` is its change to first order, J.
  bool Falls(NewtonIterate* from, NewtonIterate* to, double expected, double work) const {
    // A decrease of the residual by this factor, along a step of a definite tangent, is sufficient.
    constexpr double kPlainlyBetter = 0.1;
    // The same where the potential has too few digits to judge by.
    constexpr double kBetter = 0.5;
    // The rounding error of the potential, relative. Larger values judge more steps by the residual
    // and its work; smaller ones by noise, which may refuse every step near the solution.
    constexpr double kPotentialRounding = 1e-11;
    if (!to->residual.allFinite()) return false;
    const double ratio = to->residual.norm() / from->residual.norm();
    if (ratio <= kPlainlyBetter) return true;
    const double before = Potential(from);
    const double after = Potential(to);
    // A change below the rounding error of the potential is meaningless.
    const double digits = kPotentialRounding * (std::abs(before) + std::abs(after));
    if (std::isnan(after - before) || std::abs(expected) <= digits) {
      return work <= kSufficient * expected || ratio < kBetter;
    }
    return after - before <= kSufficient * expected;
  }

  // Shortens a step whose full length, which leads to `full`, does not decrease the potential.
  // `slope` is the change of the potential along the full step to first order, J. Leaves `at`
  // unchanged where the next iteration shall try a convexified tangent. Returns false if no length
  // decreases the potential.
  bool SearchLine(NewtonIterate* at, const Eigen::VectorXd& step, double slope,
                  const NewtonIterate& full) {
    constexpr int kMaxTrials = 30;
    // The range of the ratio of a length to the one before, and the ratio where the slope does not
    // change its sign. Smaller ratios reach short steps in fewer trials, but may skip longer ones.
    constexpr double kLeastRatio = 0.1, kLargestRatio = 0.7, kPlainRatio = 0.5;
    // A residual below this multiple of the rounding error is accepted as the solution where no
    // descent can be found. Larger values accept less accurate solutions.
    constexpr double kHidden = 100;
    double length = 1;
    double slope_there = full.residual.dot(step);
    for (int k = 0; k < kMaxTrials; ++k) {
      // To the zero of the slope by the secant rule.
      length *= slope_there > 0
                    ? std::clamp(slope / (slope - slope_there), kLeastRatio, kLargestRatio)
                    : kPlainRatio;
      NewtonIterate trial = Evaluate(at->position + length * step);
      slope_there = trial.residual.dot(step);
      if (Falls(at, &trial, length * slope, length * Work(*at, trial, step))) {
        *at = std::move(trial);
        return true;
      }
    }
    if (!convexify_) {
      convexify_ = true;
      return true;
    }
    // Close to the solution, rounding errors can hide the descent.
    if (!(at->residual.norm() <= kHidden * rounding_)) return false;
    rounding_ = at->residual.norm();
    return true;
  }

  // Always returns false.
  bool Fail(NewtonSummary::Status status, const std::string& message) {
    summary_.status = status;
    summary_.message = message;
    return false;
  }

  // The share of the decrease to first order that a step must reach, the usual choice since Armijo
  // (1966). Larger values refuse steps that serve; the solution does not depend on it.
  static constexpr double kSufficient = 1e-4;
  // The ratio of the residuals after and before a step above which it is slow. Smaller values
  // factorise the whole tangent more often.
  static constexpr double kSlow = 0.5;

  const NewtonProblem& problem_;
  LinearSolver& solver_;
  BlockMatrix& tangent_;
  NewtonSummary summary_;
  bool convexify_ = false;
  bool may_climb_ = true;
  int slow_steps_ = 0;                      // in succession, which hardly reduced the residual
  bool needs_skew_ = false;                 // the whole tangent has served, and comes first
  bool whole_fails_ = false;                // its last step did not serve
  bool has_tangent_ = false;                // `tangent_` is exact for an earlier iterate
  std::vector<Eigen::Matrix3d> rotations_;  // rotations of the nodes at that iterate
  // Residuals below this norm, N, are rounding errors. Infinite until a tangent has been assembled.
  double rounding_ = std::numeric_limits<double>::infinity();
};

}  // namespace

NewtonSummary SolveByNewton(const NewtonProblem& problem, const Eigen::VectorXd& target,
                            LinearSolver* solver, BlockMatrix* tangent, Eigen::VectorXd* position) {
  return Newton(problem, solver, tangent).Run(target, position);
}

}  // namespace lacuna
