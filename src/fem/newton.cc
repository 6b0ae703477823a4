#include "fem/newton.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "fem/node_rotations.h"

namespace lacuna {
namespace {

// An iterate with the quantities that have been evaluated at it.
struct Iterate {
  Eigen::VectorXd position;
  Eigen::VectorXd residual;         // r − applied force; held components are 0
  double force_scale = 0;           // N
  std::optional<double> potential;  // J; NaN if there is none; evaluated on demand
};

// Steps −M⁻¹ r with a fixed factor M of a tangent, each combined with the earlier ones so that the
// residual becomes smallest to first order, in the norm of M⁻¹ (Anderson 1965; for a linear
// equation this is the method of minimal residuals, Walker & Ni 2011).
class ChordSteps {
 public:
  // The step from an iterate with residual r, where `image` is M⁻¹ r. The iterate is that to which
  // the step before has led.
  Eigen::VectorXd Next(const Eigen::VectorXd& residual, const Eigen::VectorXd& image) {
    if (steps_.empty()) {
      first_residual_ = residual.norm();
    } else {
      changes_.push_back(residual - residual_);
      images_.push_back(image - image_);
    }
    residual_ = residual;
    image_ = image;
    // Minimises ‖r − Σ γ Δr‖, and steps by −M⁻¹ (r − Σ γ Δr) − Σ γ Δx.
    const Eigen::Index count = static_cast<Eigen::Index>(steps_.size());
    Eigen::MatrixXd products(count, count);
    Eigen::VectorXd right(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j)
        products(i, j) = products(j, i) = images_[i].dot(changes_[j]);
      right[i] = images_[i].dot(residual);
    }
    const Eigen::VectorXd weight = products.ldlt().solve(right);
    Eigen::VectorXd step = -image;
    for (Eigen::Index i = 0; i < count; ++i) step += weight[i] * (images_[i] - steps_[i]);
    steps_.push_back(step);
    return step;
  }

  int Count() const { return static_cast<int>(steps_.size()); }
  double FirstResidual() const { return first_residual_; }

 private:
  std::vector<Eigen::VectorXd> steps_, changes_, images_;  // of the position, of r, and of M⁻¹ r
  Eigen::VectorXd residual_, image_;
  double first_residual_ = 0;
};

class Newton {
 public:
  Newton(const NewtonProblem& problem, LinearSolver* solver, BlockMatrix* tangent)
      : problem_(problem), solver_(*solver), tangent_(*tangent) {}

  NewtonSummary Run(const Eigen::VectorXd& target, Eigen::VectorXd* position) {
    Iterate at;
    if (IterateWithFactor(target, *position, &at)) {
      *position = at.position;
      return Finish(at);
    }
    at = Evaluate(*position);
    if (MoveHeld(target, &at)) {
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
    problem_.held.ClearIn(at.residual);
    return at;
  }

  double Potential(Iterate* at) const {
    if (!at->potential) {
      at->potential =
          problem_.equation.Potential(at->position) - problem_.applied_force.dot(at->position);
    }
    return *at->potential;
  }

  bool IsConverged(const Iterate& at) const {
    const double norm = at.residual.norm();
    if (!std::isfinite(norm) || !std::isfinite(at.force_scale)) return false;
    return norm <= problem_.relative_tolerance * at.force_scale ||
           (std::isfinite(rounding_) && norm <= rounding_);
  }

  void AssembleTangent(const Iterate& at) {
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

  Eigen::VectorXd WithHeldAt(const Eigen::VectorXd& target, Eigen::VectorXd position) const {
    problem_.held.Copy(target, &position);
    return position;
  }

  // Approaches the solution with the factor M of an earlier tangent, without assembling the present
  // one, so that a step of a smooth motion costs little more than a few residuals. The factor is
  // renewed once where that is cheaper than to go on. In statics a factor of a convexified tangent
  // might lead to an unstable equilibrium, so that only steps with inertia are taken in this way.
  // Returns false where the residual does not fall in spite of a new factor.
  bool IterateWithFactor(const Eigen::VectorXd& target, const Eigen::VectorXd& start, Iterate* at) {
    constexpr int kMostIterations = 16;
    // The largest ratio of a new residual to the old one, with an old factor and with a new one.
    constexpr double kSufficientRatio = 0.5, kTolerableRatio = 0.9;
    if (!problem_.equation.has_inertia() || !solver_.KeepsFactors()) return false;
    *at = Evaluate(WithHeldAt(target, start));
    if (!at->residual.allFinite()) return false;
    if (solver_.HasFactor()) rotations_ = NodeRotations(problem_.equation.body(), at->position);
    ChordSteps steps;
    bool is_new = false;
    for (int iteration = 0; !IsConverged(*at); ++iteration) {
      if (iteration == std::min(kMostIterations, problem_.max_iterations)) return false;
      ++summary_.iterations;
      if (!is_new && (!solver_.HasFactor() || IsRenewalCheaper(steps, *at))) {
        if (!RenewFactor(*at)) return false;
        is_new = true;
        steps = {};
      }
      Eigen::VectorXd image;
      solver_.ApplyFactor(at->residual, rotations_, &image);
      Iterate next = Evaluate(at->position + steps.Next(at->residual, image));
      const double ratio = next.residual.norm() / at->residual.norm();
      if (ratio <= (is_new ? kTolerableRatio : kSufficientRatio)) {
        *at = std::move(next);
      } else if (is_new) {
        return false;
      } else {
        solver_.DropFactor();
      }
    }
    if (steps.Count() > 0) solver_.CountApplications(steps.Count());
    return true;
  }

  bool IsRenewalCheaper(const ChordSteps& steps, const Iterate& at) const {
    constexpr int kStepsToJudge = 2;
    return steps.Count() >= kStepsToJudge &&
           solver_.IsRenewalCheaper(steps.Count(), steps.FirstResidual(), at.residual.norm(),
                                    problem_.relative_tolerance * at.force_scale);
  }

  bool RenewFactor(const Iterate& at) {
    problem_.equation.Tangent(at.position, /*convexify=*/false, &tangent_);
    rotations_ = NodeRotations(problem_.equation.body(), at.position);
    return solver_.Factorise(tangent_, rotations_);
  }

  // Solves tangent · step = right() with the exact tangent or, if that is not positive definite,
  // with its convexified approximation. right() may use the assembled tangent.
  template <typename RightHandSide>
  bool SolveLinearised(const Iterate& at, const RightHandSide& right, Eigen::VectorXd* step) {
    LinearSolveSummary solved;
    rotations_ = NodeRotations(problem_.equation.body(), at.position);
    for (int attempt = 0; attempt < 2; ++attempt) {
      AssembleTangent(at);
      const Eigen::VectorXd b = right();
      solved = solver_.Solve(tangent_, b, step, &rotations_);
      const bool is_descent = solved.IsUsable() && step->allFinite() && step->dot(b) >= 0;
      has_tangent_ = is_descent && !convexify_;
      if (is_descent) return true;
      if (convexify_) break;
      convexify_ = true;
    }
    Fail(NewtonSummary::Status::kLinearSolverFailed,
         fmt::format("the linearised step could not be solved: {}", solved.message));
    return false;
  }

  // Tries a step with the tangent of an earlier iterate (the chord method). Near the solution this
  // is nearly as effective as a new tangent, whose assembly costs more than a step. Returns false
  // and leaves `at` unchanged if the residual does not decrease enough.
  bool FollowChord(Iterate* at) {
    constexpr double kSufficientRatio = 0.2;  // largest ratio of the new residual to the old one
    if (!has_tangent_ || convexify_) return false;
    has_tangent_ = false;
    Eigen::VectorXd step;
    const LinearSolveSummary solved = solver_.Solve(tangent_, -at->residual, &step, &rotations_);
    if (!solved.IsUsable() || !step.allFinite()) return false;
    Iterate next = Evaluate(at->position + step);
    if (!(next.residual.norm() / at->residual.norm() <= kSufficientRatio)) return false;
    has_tangent_ = true;
    *at = std::move(next);
    return true;
  }

  bool NewtonStep(const Iterate& at, Eigen::VectorXd* step) {
    return SolveLinearised(
        at, [&] { return Eigen::VectorXd(-at.residual); }, step);
  }

  bool MoveHeld(const Eigen::VectorXd& target, Iterate* at) {
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
      if (!SolveLinearised(*at, right, &step)) return false;
    }
    *at = Evaluate(WithHeldAt(target, at->position + step + motion));
    convexify_ = false;
    return true;
  }

  // Performs one iteration. The potential of a nearly incompressible or rotating body has a narrow
  // curved valley. A full step along its tangent leads up the side of the valley, and the next full
  // step leads back to its bottom far ahead, whereas a line search would make little progress. An
  // increase is therefore accepted if the following full step ends below the start (the watchdog
  // technique, Chamberlain et al. 1982).
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

  // Takes another full step from `full`, where the potential exceeds that of `start`, to `beyond_`,
  // and returns whether the potential there is below that of `start`. `work` is the work of the
  // residual from `start` to `full`.
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

  // The work of the residual along a step by the trapezoidal rule, J. It equals the change of the
  // potential to second order and replaces it if there is no potential.
  static double Work(const Iterate& from, const Iterate& to, const Eigen::VectorXd& step) {
    return 0.5 * (from.residual.dot(step) + to.residual.dot(step));
  }

  // Whether the potential decreases sufficiently (Armijo 1966) from one iterate to another.
  // `expected` is its change to first order, J.
  bool Falls(Iterate* from, Iterate* to, double expected, double work) const {
    constexpr double kSufficient = 1e-4;
    // A decrease of the residual by this factor, along a step of a definite tangent, is sufficient.
    constexpr double kPlainlyBetter = 0.1;
    if (!to->residual.allFinite()) return false;
    const double ratio = to->residual.norm() / from->residual.norm();
    if (ratio <= kPlainlyBetter) return true;
    const double before = Potential(from);
    const double after = Potential(to);
    // A change below the rounding error of the potential is meaningless.
    const double digits = 1e-11 * (std::abs(before) + std::abs(after));
    if (std::isnan(after - before) || std::abs(expected) <= digits) {
      return work <= kSufficient * expected || ratio < 0.5;
    }
    return after - before <= kSufficient * expected;
  }

  // Shortens a step whose full length, which leads to `full`, does not decrease the potential.
  bool SearchLine(Iterate* at, const Eigen::VectorXd& step, const Iterate& full) {
    constexpr int kMaxTrials = 30;
    const double slope = at->residual.dot(step);
    double length = 1;
    double slope_there = full.residual.dot(step);
    for (int k = 0; k < kMaxTrials; ++k) {
      // The zero of the slope by the secant rule, limited to a safe range.
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
    // Close to the solution, rounding errors can hide the descent.
    if (at->residual.norm() <= 100 * rounding_) {
      rounding_ = at->residual.norm();
      return true;
    }
    Fail(NewtonSummary::Status::kNoConvergence, "no descent along the Newton direction");
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
  bool has_tangent_ = false;                // `tangent_` is exact for an earlier iterate
  std::vector<Eigen::Matrix3d> rotations_;  // rotations of the nodes at that iterate
  Iterate beyond_;
  // Residuals below this norm, N, are rounding errors. Infinite until a tangent has been assembled.
  double rounding_ = std::numeric_limits<double>::infinity();
};

}  // namespace

NewtonSummary SolveByNewton(const NewtonProblem& problem, const Eigen::VectorXd& target,
                            LinearSolver* solver, BlockMatrix* tangent, Eigen::VectorXd* position) {
  return Newton(problem, solver, tangent).Run(target, position);
}

}  // namespace lacuna
