#include "fem/newton.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lacuna {
namespace {

// A point of the iteration with what has been evaluated there.
struct Iterate {
  Eigen::VectorXd position;
  Eigen::VectorXd residual;  // r − applied, 0 at fixed nodes
  double force_scale = 0;    // N
  double potential = 0;      // J; NaN where there is none
};

class Newton {
 public:
  Newton(const NewtonProblem& problem, LinearSolver* solver, BlockMatrix* tangent)
      : problem_(problem), solver_(*solver), tangent_(*tangent) {}

  NewtonSummary Run(const Eigen::VectorXd& target, Eigen::VectorXd* position) {
    Iterate at = Evaluate(*position);
    if (!MoveFixedNodes(target, &at)) {
      *position = at.position;
      return Finish(at);
    }
    Iterate trial;
    Eigen::VectorXd step;
    while (!IsConverged(at)) {
      if (summary_.iterations >= problem_.max_iterations) {
        Fail(NewtonSummary::Status::kNoConvergence,
             fmt::format("no convergence in {} iterations", summary_.iterations));
        break;
      }
      ++summary_.iterations;
      if (!NewtonStep(at, &step)) break;
      double length = 0;
      if (!SearchLine(at, step, &trial, &length)) {
        if (!convexify_) {
          convexify_ = true;
          continue;
        }
        if (at.residual.norm() <= 100 * rounding_) break;
        Fail(NewtonSummary::Status::kNoConvergence, "no smaller residual along Newton's direction");
        break;
      }
      std::swap(at, trial);
      // Near the solution the exact tangent is definite again and converges quadratically.
      if (length == 1) convexify_ = false;
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
    at.potential = problem_.equation.Potential(position) - problem_.applied_force.dot(position);
    return at;
  }

  void ClearFixed(Eigen::VectorXd* vector) const {
    for (size_t i = 0; i < problem_.fixed.size(); ++i) {
      if (problem_.fixed[i]) vector->segment<3>(3 * i).setZero();
    }
  }

  bool IsConverged(const Iterate& at) const {
    const double norm = at.residual.norm();
    return norm <= problem_.relative_tolerance * at.force_scale || norm <= rounding_;
  }

  void AssembleTangent(const Iterate& at) {
    problem_.equation.Tangent(at.position, convexify_, &tangent_);
    // Positions are known to ε |x|, so forces to about ε |x| times the stiffest spring.
    double stiffest = 0;
    for (const int k : tangent_.pattern().diagonal) {
      stiffest = std::max(stiffest, tangent_.Block(k).diagonal().maxCoeff());
    }
    rounding_ = 4 * std::numeric_limits<double>::epsilon() * stiffest *
                at.position.lpNorm<Eigen::Infinity>() *
                std::sqrt(static_cast<double>(at.position.size()));
  }

  // Solves tangent · step = right-hand side with the exact tangent or, if that is not definite,
  // with its stand-in. `right(tangent)` makes the right-hand side.
  template <typename RightHandSide>
  bool SolveLinearised(const Iterate& at, const RightHandSide& right, Eigen::VectorXd* step) {
    LinearSolveSummary solved;
    for (int attempt = 0; attempt < 2; ++attempt) {
      AssembleTangent(at);
      const Eigen::VectorXd b = right();
      solved = solver_.Solve(tangent_, b, step);
      if (solved.IsUsable() && step->allFinite() && step->dot(b) >= 0) return true;
      if (convexify_) break;
      convexify_ = true;
    }
    Fail(NewtonSummary::Status::kLinearSolverFailed,
         fmt::format("the linearised step could not be solved: {}", solved.message));
    return false;
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

  // Shortens the step until the potential falls (Armijo 1966). Without a potential, the work of the
  // residual along the step, by the trapezoidal rule, stands in for its change.
  bool SearchLine(const Iterate& at, const Eigen::VectorXd& step, Iterate* trial,
                  double* length) const {
    constexpr int kMaxTrials = 30;
    constexpr double kSufficientDecrease = 1e-4;
    const double slope = at.residual.dot(step);
    double alpha = 1;
    for (int k = 0; k < kMaxTrials; ++k) {
      *trial = Evaluate(at.position + alpha * step);
      const double slope_there = trial->residual.dot(step);
      if (trial->residual.allFinite()) {
        const double work = 0.5 * alpha * (slope + slope_there);
        const double change = trial->potential - at.potential;
        // Below the rounding of the potential's own value its change says nothing.
        const double digits = 1e-11 * (std::abs(at.potential) + std::abs(trial->potential));
        const bool blind = std::isnan(change) || std::abs(alpha * slope) <= digits;
        const bool falls = (blind ? work : change) <= kSufficientDecrease * alpha * slope;
        if (falls || (blind && trial->residual.norm() < 0.5 * at.residual.norm())) {
          *length = alpha;
          return true;
        }
      }
      // The zero of the slope by the secant rule, kept within sensible bounds.
      const double secant = slope / (slope - slope_there);
      alpha *= slope_there > 0 ? std::clamp(secant, 0.1, 0.7) : 0.5;
    }
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
  double rounding_ = 0;  // N: residuals below this are rounding errors
};

}  // namespace

NewtonSummary SolveByNewton(const NewtonProblem& problem, const Eigen::VectorXd& target,
                            LinearSolver* solver, BlockMatrix* tangent, Eigen::VectorXd* position) {
  return Newton(problem, solver, tangent).Run(target, position);
}

}  // namespace lacuna
