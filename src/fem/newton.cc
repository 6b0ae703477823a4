#include "fem/newton.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "fem/node_rotations.h"

namespace lacuna {
namespace {

// A point of the iteration with what has been evaluated there.
struct Iterate {
  Eigen::VectorXd position;
  Eigen::VectorXd residual;         // r − applied, 0 at fixed nodes
  double force_scale = 0;           // N
  std::optional<double> potential;  // J; NaN where there is none; evaluated when first needed
};

class Newton {
 public:
  Newton(const NewtonProblem& problem, LinearSolver* solver, BlockMatrix* tangent)
      : problem_(problem), solver_(*solver), tangent_(*tangent) {}

  NewtonSummary Run(const Eigen::VectorXd& target, Eigen::VectorXd* position) {
    Iterate at = Evaluate(*position);
    if (MoveFixedNodes(target, &at)) {
      while (!IsConverged(at)) {
        if (summary_.iterations >= problem_.max_iterations) {
          Fail(NewtonSummary::Status::kNoConvergence,
               fmt::format("no convergence in {} iterations", summary_.iterations));
          break;
        }
        ++summary_.iterations;
        if (!Advance(&at)) break;
      }
    }
    *position = at.position;
    return Finish(at);
  }

 private:
  Iterate Evaluate(const Eigen::VectorXd& position) const {
    Iterate at;
    at.position = position;
    problem_.equation.Residual(position, &at.residual, &at.force_scale);
    at.residual -= problem_.applied_force;
    at.force_scale += problem_.applied_force.norm();
    ClearFixed(&at.residual);
    return at;
  }

  double Potential(Iterate* at) const {
    if (!at->potential) {
      at->potential =
          problem_.equation.Potential(at->position) - problem_.applied_force.dot(at->position);
    }
    return *at->potential;
  }

  void ClearFixed(Eigen::VectorXd* vector) const {
    for (size_t i = 0; i < problem_.fixed.size(); ++i) {
      if (problem_.fixed[i]) vector->segment<3>(3 * i).setZero();
    }
  }

  bool IsConverged(const Iterate& at) const {
    const double norm = at.residual.norm();
    if (!std::isfinite(norm) || !std::isfinite(at.force_scale)) return false;
    return norm <= problem_.relative_tolerance * at.force_scale ||
           (std::isfinite(rounding_) && norm <= rounding_);
  }

  void AssembleTangent(const Iterate& at) {
    problem_.equation.Tangent(at.position, convexify_, &tangent_);
    // Positions are known to ε |x|, so forces to about ε |x| times the stiffest spring. Of all the
    // places visited the tamest counts.
    double stiffest = 0;
    for (const int k : tangent_.pattern().diagonal) {
      stiffest = std::max(stiffest, tangent_.Block(k).diagonal().maxCoeff());
    }
    rounding_ = std::min(rounding_, 4 * std::numeric_limits<double>::epsilon() * stiffest *
                                        at.position.lpNorm<Eigen::Infinity>() *
                                        std::sqrt(static_cast<double>(at.position.size())));
  }

  // Solves tangent · step = right-hand side with the exact tangent or, if that is not definite,
  // with its stand-in. `right(tangent)` makes the right-hand side.
  template <typename RightHandSide>
  bool SolveLinearised(const Iterate& at, const RightHandSide& right, Eigen::VectorXd* step) {
    LinearSolveSummary solved;
    rotations_ = NodeRotations(problem_.equation.body(), at.position);
    for (int attempt = 0; attempt < 2; ++attempt) {
      AssembleTangent(at);
      const Eigen::VectorXd b = right();
      solved = solver_.Solve(tangent_, b, step, &rotations_);
      const bool goes_down = solved.IsUsable() && step->allFinite() && step->dot(b) >= 0;
      has_tangent_ = goes_down && !convexify_;
      if (goes_down) return true;
      if (convexify_) break;
      convexify_ = true;
    }
    Fail(NewtonSummary::Status::kLinearSolverFailed,
         fmt::format("the linearised step could not be solved: {}", solved.message));
    return false;
  }

  // Near the solution the tangent of an earlier iterate does nearly as well, and assembling a new
  // one costs more than a step (the chord method). False, with `at` as it was, where it does not.
  bool FollowChord(Iterate* at) {
    constexpr double kGoesOn = 0.2;  // of the residual
    if (!has_tangent_ || convexify_) return false;
    has_tangent_ = false;
    Eigen::VectorXd step;
    const LinearSolveSummary solved = solver_.Solve(tangent_, -at->residual, &step, &rotations_);
    if (!solved.IsUsable() || !step.allFinite()) return false;
    Iterate next = Evaluate(at->position + step);
    if (!(next.residual.norm() / at->residual.norm() <= kGoesOn)) return false;
    has_tangent_ = true;
    *at = std::move(next);
    return true;
  }

  bool NewtonStep(const Iterate& at, Eigen::VectorXd* step) {
    return SolveLinearised(
        at, [&] { return Eigen::VectorXd(-at.residual); }, step);
  }

  bool MoveFixedNodes(const Eigen::VectorXd& target, Iterate* at) {
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(target.size());
    bool all_fixed = true;
    for (size_t i = 0; i < problem_.fixed.size(); ++i) {
      all_fixed = all_fixed && problem_.fixed[i];
      if (problem_.fixed[i]) {
        motion.segment<3>(3 * i) = target.segment<3>(3 * i) - at->position.segment<3>(3 * i);
      }
    }
    if (motion.isZero(0)) return true;
    Eigen::VectorXd step = Eigen::VectorXd::Zero(target.size());
    if (!all_fixed) {
      ++summary_.iterations;
      const auto right = [&] {
        Eigen::VectorXd b;
        tangent_.Multiply(motion, &b);
        b = -(b + at->residual);
        ClearFixed(&b);
        return b;
      };
      if (!SolveLinearised(*at, right, &step)) return false;
    }
    Eigen::VectorXd moved = at->position + step + motion;
    for (size_t i = 0; i < problem_.fixed.size(); ++i) {
      if (problem_.fixed[i]) moved.segment<3>(3 * i) = target.segment<3>(3 * i);
    }
    *at = Evaluate(moved);
    convexify_ = false;
    return true;
  }

  // One iteration. Nearly incompressible and turning bodies lie at the bottom of a narrow curved
  // valley of the potential: a full step along its tangent climbs the wall, and the next falls back
  // far ahead, where a line search would creep along the bottom. So a climb is forgiven when the
  // step after it ends below where it began (the watchdog technique, Chamberlain et al. 1982).
  bool Advance(Iterate* at) {
    if (FollowChord(at)) return true;
    Eigen::VectorXd step;
    if (!NewtonStep(*at, &step)) return false;
    Iterate full = Evaluate(at->position + step);
    const double slope = at->residual.dot(step);
    const double work = Work(*at, full, step);
    if (Falls(at, &full, slope, work)) {
      *at = std::move(full);
      // Near the solution the exact tangent is definite and converges quadratically.
      convexify_ = false;
      may_climb_ = true;
      return true;
    }
    if (may_climb_ && ReturnsBelow(at, slope, work, full)) {
      *at = std::move(beyond_);
      convexify_ = false;
      return true;
    }
    may_climb_ = false;
    return SearchLine(at, step, full);
  }

  // Takes another full step from `full`, where the potential is above that of `start`, to
  // `beyond_`; true if it is below there. `work`: of the residual from start to full.
  bool ReturnsBelow(Iterate* start, double slope, double work, const Iterate& full) {
    if (!full.residual.allFinite() || summary_.iterations >= problem_.max_iterations) return false;
    ++summary_.iterations;
    Eigen::VectorXd step;
    if (!NewtonStep(full, &step)) {
      summary_.status = NewtonSummary::Status::kNotRun;
      return false;
    }
    beyond_ = Evaluate(full.position + step);
    return Falls(start, &beyond_, slope, work + Work(full, beyond_, step));
  }

  // The work of the residual along a step, by the trapezoidal rule, J: to second order the change
  // of the potential, and its stand-in where there is none.
  static double Work(const Iterate& from, const Iterate& to, const Eigen::VectorXd& step) {
    return 0.5 * (from.residual.dot(step) + to.residual.dot(step));
  }

  // Sufficient decrease (Armijo 1966) of the potential from one iterate to another.
  // `expected`: its change to first order, J.
  bool Falls(Iterate* from, Iterate* to, double expected, double work) const {
    constexpr double kSufficient = 1e-4;
    // A residual that drops this much, along a step of a definite tangent, needs no other witness.
    constexpr double kPlainlyBetter = 0.1;
    if (!to->residual.allFinite()) return false;
    const double ratio = to->residual.norm() / from->residual.norm();
    if (ratio <= kPlainlyBetter) return true;
    const double before = Potential(from);
    const double after = Potential(to);
    // Below the rounding of the potential's own value its change says nothing.
    const double digits = 1e-11 * (std::abs(before) + std::abs(after));
    if (std::isnan(after - before) || std::abs(expected) <= digits) {
      return work <= kSufficient * expected || ratio < 0.5;
    }
    return after - before <= kSufficient * expected;
  }

  // Shortens a step whose full length, to `full`, is too far.
  bool SearchLine(Iterate* at, const Eigen::VectorXd& step, const Iterate& full) {
    constexpr int kMaxTrials = 30;
    const double slope = at->residual.dot(step);
    double length = 1;
    double slope_there = full.residual.dot(step);
    for (int k = 0; k < kMaxTrials; ++k) {
      // The zero of the slope by the secant rule, kept within sensible bounds.
      length *= slope_there > 0 ? std::clamp(slope / (slope - slope_there), 0.1, 0.7) : 0.5;
      Iterate trial = Evaluate(at->position + length * step);
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
    // So near the solution that rounding hides the way down.
    if (at->residual.norm() <= 100 * rounding_) {
      rounding_ = at->residual.norm();
      return true;
    }
    Fail(NewtonSummary::Status::kNoConvergence, "no way down along Newton's direction");
    return false;
  }

  void Fail(NewtonSummary::Status status, const std::string& message) {
    summary_.status = status;
    summary_.message = message;
  }

  NewtonSummary Finish(const Iterate& at) {
    Eigen::Index worst = 0;
    summary_.residual = at.residual.size() > 0 ? at.residual.cwiseAbs().maxCoeff(&worst) : 0;
    if (summary_.status == NewtonSummary::Status::kNotRun) {
      summary_.status = NewtonSummary::Status::kConverged;
    } else {
      summary_.message +=
          fmt::format("; largest residual {:.3g} N at node {}", summary_.residual, worst / 3);
    }
    return summary_;
  }

  const NewtonProblem& problem_;
  LinearSolver& solver_;
  BlockMatrix& tangent_;
  NewtonSummary summary_;
  bool convexify_ = false;
  bool may_climb_ = true;
  bool has_tangent_ = false;                // `tangent_` is the exact one of an earlier iterate
  std::vector<Eigen::Matrix3d> rotations_;  // of the nodes there
  Iterate beyond_;
  // N: residuals below this are rounding errors; known once there is a tangent
  double rounding_ = std::numeric_limits<double>::infinity();
};

}  // namespace

NewtonSummary SolveByNewton(const NewtonProblem& problem, const Eigen::VectorXd& target,
                            LinearSolver* solver, BlockMatrix* tangent, Eigen::VectorXd* position) {
  return Newton(problem, solver, tangent).Run(target, position);
}

}  // namespace lacuna
