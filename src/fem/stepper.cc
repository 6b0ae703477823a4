#include "fem/stepper.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "fem/held_components.h"
#include "fem/inverted_element.h"
#include "fem/missing_mass.h"
#include "fem/newton.h"

namespace lacuna {
namespace {

// The components that the grips hold. Throws InputError where the constructor of Stepper does.
HeldComponents CheckedHeldComponents(const Model& model) {
  const int nodes = model.body->NodeCount();
  // Along which axes each node is held at all, and by supports at rest along some axes only.
  std::vector<AxisSet> held(nodes), at_rest(nodes);
  for (const Grip& grip : model.grips) {
    const bool may_share = !grip.motion && grip.axes.IsPartial();
    for (const int node : grip.nodes) {
      if (node < 0 || node >= nodes) {
        throw InputError(
            fmt::format("a grip holds node {}; the mesh has nodes 0 to {}", node, nodes - 1));
      }
      const AxisSet shared = grip.axes & held[node];
      if (!shared.IsEmpty() && !(may_share && shared == (shared & at_rest[node])))
        throw InputError(fmt::format("node {} belongs to more than one grip", node));
      held[node] = held[node] | grip.axes;
      if (may_share) at_rest[node] = at_rest[node] | grip.axes;
    }
  }
  return HeldComponents(std::move(held));
}

// `position` with the gripped nodes at the positions that their grips prescribe at `time`.
Eigen::VectorXd Gripped(const Model& model, double time, Eigen::VectorXd position) {
  for (const Grip& grip : model.grips) {
    Eigen::Matrix3Xd places(3, grip.nodes.size());
    if (grip.motion) {
      places = grip.motion(time);
      CHECK_EQ(places.cols(), grip.nodes.size()) << "a grip's motion must place all its nodes";
    } else {
      for (Eigen::Index k = 0; k < grip.nodes.size(); ++k) {
        places.col(k) = model.body->mesh.nodes.col(grip.nodes[k]);
      }
    }
    for (Eigen::Index k = 0; k < grip.nodes.size(); ++k)
      for (int axis = 0; axis < 3; ++axis)
        if (grip.axes.Has(axis)) position[3 * grip.nodes[k] + axis] = places(axis, k);
  }
  return position;
}

// The position to which constant acceleration would lead; in statics, that at the start.
Eigen::VectorXd FirstGuess(const StepEquation& equation, const MotionHistory& history) {
  Eigen::VectorXd position = history.position;
  if (!equation.has_inertia()) return position;
  const double time_step = equation.time_step();
  position += time_step * history.velocity;
  if (history.acceleration.size() > 0)
    position += 0.5 * time_step * time_step * history.acceleration;
  return position;
}

StepSummary::Status StepStatus(NewtonSummary::Status status) {
  switch (status) {
    case NewtonSummary::Status::kConverged:
      return StepSummary::Status::kConverged;
    case NewtonSummary::Status::kNoConvergence:
      return StepSummary::Status::kNoConvergence;
    case NewtonSummary::Status::kLinearSolverFailed:
      return StepSummary::Status::kLinearSolverFailed;
    case NewtonSummary::Status::kNotRun:
      break;
  }
  return StepSummary::Status::kNotRun;
}

}  // namespace

struct Stepper::Implementation {
  Implementation(const Model& the_model, const StepOptions& the_options)
      : model(the_model),
        options(the_options),
        held(CheckedHeldComponents(model)),
        solver(model.body->pattern, held, options.linear),
        tangent(model.body->pattern),
        missing_mass(DescribeMissingMass(model)) {}

  // Where Newton's method has led to.
  struct StepEnd {
    NewtonSummary newton;
    Eigen::VectorXd position;  // 3n, m
    int inverted = -1;         // an inverted element that is refused; −1: none
    bool IsUsable() const { return newton.IsUsable() && inverted < 0; }
  };

  NewtonSummary Solve(const NewtonProblem& problem, const Eigen::VectorXd& target,
                      Eigen::VectorXd* position) {
    return SolveByNewton(problem, target, &solver, &tangent, position);
  }

  // Continuation from the start, which an applied force r(start) holds in balance, to the wanted
  // state: that force is removed and the grips are moved in fractions.
  NewtonSummary SolveByIncrements(const NewtonProblem& problem, const Eigen::VectorXd& target,
                                  Eigen::VectorXd* position) {
    constexpr double kSmallestIncrement = 1.0 / 512;
    // Limits the total number of iterations, as a multiple of those of one solution. Continuations
    // that succeed need far fewer; without the limit, a fit that tries parameters without an
    // equilibrium would spend most of its time here.
    constexpr int kMostSolutions = 4;
    const Eigen::VectorXd start = *position;
    Eigen::VectorXd imbalance;
    problem.equation.Residual(start, &imbalance);
    imbalance -= problem.applied_force;
    double reached = 0, increment = 0.25;
    NewtonSummary summary;
    int iterations = 0;
    while (reached < 1) {
      const double aim = std::min(1.0, reached + increment);
      const Eigen::VectorXd force = problem.applied_force + (1 - aim) * imbalance;
      Eigen::VectorXd trial = *position;
      solver.DropFactor();
      summary = Solve({problem.equation, force, problem.held, problem.relative_tolerance,
                       problem.max_iterations},
                      start + aim * (target - start), &trial);
      iterations += summary.iterations;
      if (summary.IsUsable()) {
        reached = aim;
        *position = trial;
        if (summary.iterations <= 6) increment *= 1.5;
      } else {
        increment *= 0.5;
        if (increment < kSmallestIncrement ||
            iterations >= kMostSolutions * problem.max_iterations) {
          summary.message += fmt::format("; {:.1f} % of the load could be applied", 100 * reached);
          break;
        }
      }
    }
    summary.iterations = iterations;
    return summary;
  }

  StepEnd EndAt(NewtonSummary newton, Eigen::VectorXd position) const {
    const bool is_checked = options.refuse_inverted && newton.IsUsable();
    const int inverted = is_checked ? FindInvertedElement(*model.body, position) : -1;
    return {std::move(newton), std::move(position), inverted};
  }

  // The end of a step, in increments if it is not reached directly.
  StepEnd FindEnd(const NewtonProblem& problem, const Eigen::VectorXd& target,
                  const MotionHistory& history) {
    Eigen::VectorXd position = FirstGuess(problem.equation, history);
    NewtonSummary newton = Solve(problem, target, &position);
    StepEnd direct = EndAt(std::move(newton), std::move(position));
    if (direct.IsUsable()) return direct;
    position = history.position;
    newton = SolveByIncrements(problem, target, &position);
    newton.iterations += direct.newton.iterations;
    return EndAt(std::move(newton), std::move(position));
  }

  StepSummary Take(TimeScheme scheme, double time_step, const Eigen::VectorXd& external_force,
                   double tolerance, MotionHistory* history) {
    const Eigen::Index size = history->position.size();
    CHECK(external_force.size() == 0 || external_force.size() == size);
    const Eigen::VectorXd force =
        external_force.size() > 0 ? external_force : Eigen::VectorXd::Zero(size);
    const StepEquation equation(model, *history, scheme, time_step);
    if (!missing_mass.empty()) return NotTaken(StepSummary::Status::kMissingMass, missing_mass);
    const Eigen::VectorXd target = Gripped(model, equation.end_time(), history->position);
    if (!target.allFinite() || !force.allFinite()) {
      return NotTaken(
          StepSummary::Status::kNoConvergence,
          fmt::format("at {:.6g} s: a grip's position or an external force is not finite",
                      equation.end_time()));
    }
    const int factorisations_before = solver.factorisations();
    const StepEnd end =
        FindEnd({equation, force, held, tolerance, options.max_iterations}, target, *history);
    StepSummary summary = Summarise(end, equation.end_time());
    summary.factorisations = solver.factorisations() - factorisations_before;
    if (summary.IsUsable()) *history = equation.Advance(end.position);
    return summary;
  }

  static StepSummary NotTaken(StepSummary::Status status, const std::string& why) {
    StepSummary summary;
    summary.status = status;
    summary.message = why;
    return summary;
  }

  // The summary of a step that ends at `time`, s, without its factorisations.
  static StepSummary Summarise(const StepEnd& end, double time) {
    StepSummary summary;
    summary.iterations = end.newton.iterations;
    summary.residual = end.newton.residual;
    summary.status = StepStatus(end.newton.status);
    if (!end.newton.IsUsable()) {
      summary.message = fmt::format("at {:.6g} s: {}", time, end.newton.message);
    } else if (end.inverted >= 0) {
      summary.status = StepSummary::Status::kInvertedElement;
      summary.message = fmt::format("at {:.6g} s: element {} is inverted", time, end.inverted);
    }
    return summary;
  }

  const Model model;
  const StepOptions options;
  const HeldComponents held;
  LinearSolver solver;
  BlockMatrix tangent;
  const std::string missing_mass;  // why no step can be taken; empty otherwise
};

Stepper::Stepper(const Model& model, const StepOptions& options)
    : implementation_(std::make_unique<Implementation>(model, options)) {}
Stepper::~Stepper() = default;
Stepper::Stepper(Stepper&&) noexcept = default;
Stepper& Stepper::operator=(Stepper&&) noexcept = default;

StepSummary Stepper::Step(double time_step, const Eigen::VectorXd& external_force,
                          MotionHistory* history) {
  CHECK_GT(time_step, 0);
  const StepOptions& options = implementation_->options;
  return implementation_->Take(options.scheme, time_step, external_force,
                               options.relative_tolerance, history);
}

StepSummary Stepper::Equilibrium(const Eigen::VectorXd& external_force, MotionHistory* history,
                                 double tighter) {
  CHECK_GT(tighter, 0);
  return implementation_->Take(TimeScheme::kQuasiStatic, 0, external_force,
                               tighter * implementation_->options.relative_tolerance, history);
}

}  // namespace lacuna
