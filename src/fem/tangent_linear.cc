#include "fem/tangent_linear.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "fem/held_components.h"
#include "fem/largest_entry.h"
#include "fem/tangent_solver.h"

namespace lacuna {
namespace {

Eigen::MatrixXd ScaledRows(const Eigen::VectorXd& node_weight, Eigen::MatrixXd columns) {
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    columns.col(k).reshaped(3, node_weight.size()).array().rowwise() *=
        node_weight.transpose().array();
  }
  return columns;
}

// The sensitivity of the internal variables z of an effect of the model. Their values are in the
// history of the motion.
struct StateSensitivity {
  std::shared_ptr<const Effect> effect;
  Eigen::MatrixXd value;  // dz/dp, state × perturbations
};

// The internal variables of an effect that a perturbation adds to the model.
struct OutsideState {
  std::shared_ptr<const Effect> effect;  // null if the perturbation adds none
  Eigen::VectorXd value;                 // z
};

}  // namespace

struct TangentLinear::Implementation {
  Model model;
  std::vector<Perturbation> perturbations;
  TangentSolver solver;
  // The tangent of a step, its skew part, and the parts by velocity, times the rate, and by
  // acceleration.
  BlockMatrix tangent, skew, by_velocity, by_acceleration;
  bool has_skew = false, has_velocity = false, has_acceleration = false;
  TangentLinearOptions options;
  // Sensitivities at the current time and one step earlier.
  Eigen::MatrixXd position, velocity, acceleration;
  Eigen::MatrixXd previous_position, previous_velocity, previous_acceleration;
  Eigen::MatrixXd reaction;  // at the current time
  // These belong to the step being made: x̃ and ṽ, the right-hand side, the sensitivities at its
  // end.
  Eigen::MatrixXd position_history, velocity_history, right, moved;
  std::vector<StateSensitivity> inside;  // one per effect of the model
  std::vector<OutsideState> outside;     // one per perturbation

  Implementation(const Model& the_model, std::vector<Perturbation> the_perturbations,
                 const TangentLinearOptions& the_options)
      : model(the_model),
        perturbations(std::move(the_perturbations)),
        solver(*model.body->pattern, HeldComponents(HeldAxes(model)), the_options.tolerance),
        tangent(model.body->pattern),
        skew(model.body->pattern),
        by_velocity(model.body->pattern),
        by_acceleration(model.body->pattern),
        options(the_options) {
    const Eigen::Index size = 3 * model.body->NodeCount();
    position = velocity = acceleration = Eigen::MatrixXd::Zero(size, Count());
    previous_position = previous_velocity = previous_acceleration = position;
    position_history = velocity_history = right = moved = reaction = position;
    for (const auto& effect : model.effects) {
      inside.push_back({effect, Eigen::MatrixXd::Zero(effect->StateSize(*model.body), Count())});
    }
    for (const Perturbation& perturbation : perturbations) {
      OutsideState memory;
      if (perturbation.effect != nullptr && IndexInModel(*perturbation.effect) < 0) {
        memory.effect = perturbation.effect;
        memory.value.resize(memory.effect->StateSize(*model.body));
        memory.effect->InitialState(*model.body, &memory.value);
      }
      outside.push_back(std::move(memory));
    }
  }

  Eigen::Index Count() const { return static_cast<Eigen::Index>(perturbations.size()); }

  int IndexInModel(const Effect& effect) const {
    for (size_t j = 0; j < model.effects.size(); ++j)
      if (model.effects[j].get() == &effect) return static_cast<int>(j);
    return -1;
  }

  // ∂f/∂p at the end of the step.
  Eigen::VectorXd ParameterForce(const StepEquation& equation, const StepEquation::EndOfStep& end,
                                 Eigen::Index k) const {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(end.position.size());
    const Perturbation& perturbation = perturbations[k];
    if (equation.rate() == 0 && perturbation.held_force.size() > 0)
      force += perturbation.held_force;
    if (perturbation.effect == nullptr) return force;
    const int j = IndexInModel(*perturbation.effect);
    if (j >= 0) {
      equation.AddParameterForce(end, j, perturbation.parameter, &force);
    } else {
      perturbation.effect->AddParameterDerivative(AtOutside(equation, end, k),
                                                  perturbation.parameter, &force);
    }
    return force;
  }

  Kinematics AtOutside(const StepEquation& equation, const StepEquation::EndOfStep& end,
                       Eigen::Index k) const {
    return {.body = *model.body,
            .position = end.position,
            .velocity = end.velocity,
            .acceleration = end.acceleration,
            .time = equation.end_time(),
            .time_step = equation.time_step(),
            .state = outside[k].value,
            .elasticity = ElasticityOf(model),
            .has_inertia = equation.has_inertia()};
  }

  // Σ ∂f/∂z ζ over the effects with memory.
  void AddMemoryForces(const StepEquation& equation, const StepEquation::EndOfStep& end) {
    for (size_t j = 0; j < inside.size(); ++j) {
      const Eigen::MatrixXd& change = inside[j].value;
      if (change.rows() == 0 || change.isZero(0)) continue;
      const Kinematics at = equation.At(end, j);
      ForEachGroup(Count(), [&](const ColumnGroup& group) {
        inside[j].effect->AddStateDerivatives(at, group.Of(change), group.Of(right));
      });
    }
  }

  // dz/dp at the end of the step, from the sensitivities there.
  void AdvanceMemories(const StepEquation& equation, const StepEquation::EndOfStep& end) {
    for (size_t j = 0; j < inside.size(); ++j) {
      StateSensitivity& memory = inside[j];
      if (memory.value.rows() == 0) continue;
      const Kinematics at = equation.At(end, j);
      ForEachGroup(Count(), [&](const ColumnGroup& group) {
        memory.effect->AdvanceStateDerivatives(at, group.Of(position), group.Of(memory.value));
        for (Eigen::Index k = group.first; k < group.first + group.count; ++k)
          if (perturbations[k].effect == memory.effect)
            memory.effect->AddStateByParameter(at, perturbations[k].parameter, memory.value.col(k));
      });
    }
    ParallelFor(Count(), 1, [&](int64_t k) {
      if (outside[k].value.size() == 0) return;
      const Eigen::VectorXd before = outside[k].value;
      const Kinematics at = AtOutside(equation, end, k);
      outside[k].effect->AdvanceState(at.WithState(before), &outside[k].value);
    });
  }

  // The tangents at the end of the step.
  void Assemble(const StepEquation& equation, const StepEquation::EndOfStep& end,
                const Eigen::VectorXd& at) {
    equation.Tangent(at, /*convexify=*/false, &tangent);
    has_skew = equation.SkewTangent(at, &skew);
    has_velocity = has_acceleration = false;
    if (equation.rate() == 0) return;
    // Most effects depend on the position only and contribute nothing.
    const auto assemble = [&](const TangentWeights& weights, BlockMatrix* matrix) {
      matrix->SetZero();
      for (size_t j = 0; j < model.effects.size(); ++j) {
        const Kinematics kinematics = equation.At(end, j);
        model.effects[j]->AddTangents(kinematics, weights, false, matrix);
        model.effects[j]->AddSkewTangents(kinematics, weights, matrix);
      }
      return LargestEntry(*matrix) != 0;
    };
    has_velocity = assemble({.velocity = equation.rate()}, &by_velocity);
    has_acceleration = assemble({.acceleration = 1}, &by_acceleration);
  }

  // The part of the right-hand side that earlier sensitivities make.
  void AddHistory(const StepEquation& equation, const ColumnGroup& group) {
    const SchemeWeights& weights = equation.weights();
    const double rate = equation.rate();
    using Columns = decltype(group.Of(position));
    auto at = group.Of(position_history), speed = group.Of(velocity_history);
    at = weights.Combine<Columns, Eigen::MatrixXd>(group.Of(position), group.Of(previous_position),
                                                   group.Of(velocity), group.Of(previous_velocity));
    speed = weights.Combine<Columns, Eigen::MatrixXd>(
        group.Of(velocity), group.Of(previous_velocity), group.Of(acceleration),
        group.Of(previous_acceleration));
    if (rate == 0) return;
    auto sum = group.Of(right);
    if (equation.has_inertia()) {
      const Eigen::MatrixXd carried = rate * rate * at + rate * speed;
      sum += ScaledRows(model.body->node_mass, carried);
      if (has_acceleration) sum -= by_acceleration * carried;
    }
    if (has_velocity) sum -= by_velocity * Eigen::MatrixXd(at);
  }

  // The sensitivities of the held components; 0 elsewhere.
  void PlaceGrips(const StepEquation& equation, const Eigen::VectorXd& at) {
    moved.setZero();
    Eigen::VectorXd force;
    for (Eigen::Index k = 0; k < Count(); ++k) {
      if (!perturbations[k].grip) continue;
      if (force.size() == 0) equation.Residual(at, &force);
      const Eigen::VectorXd change = perturbations[k].grip(equation.end_time(), force);
      Eigen::VectorXd own = Eigen::VectorXd::Zero(change.size());
      solver.held().Copy(change, &own);
      moved.col(k) = own;
    }
  }

  void SubtractGrips(const ColumnGroup& group) {
    const Eigen::MatrixXd gripped = group.Of(moved);
    if (gripped.isZero(0)) return;
    group.Of(right) -= tangent * gripped;
    if (has_skew) group.Of(right) -= skew * gripped;
  }

  // Adds the solution of (tangent + skew) · s = right at the free nodes to `moved`.
  bool Solve(const StepEquation& equation, const Eigen::VectorXd& at) {
    return solver.AddSolution({tangent, has_skew ? &skew : nullptr, right,
                               [&](const ColumnGroup& group) -> Eigen::MatrixXd {
                                 return 2 * group.Of(position) - group.Of(previous_position);
                               },
                               [&] {
                                 BlockMatrix convexified(model.body->pattern);
                                 equation.Tangent(at, /*convexify=*/true, &convexified);
                                 return convexified;
                               }},
                              &moved);
  }

  // Makes the end of the step the current time.
  void Accept(const StepEquation& equation, const ColumnGroup& group) {
    const double rate = equation.rate();
    const auto end = group.Of(moved);
    if (options.with_reactions) {
      group.Of(reaction) += tangent * Eigen::MatrixXd(end);
      if (has_skew) group.Of(reaction) += skew * Eigen::MatrixXd(end);
    }
    group.Of(previous_position) = group.Of(position);
    group.Of(previous_velocity) = group.Of(velocity);
    group.Of(previous_acceleration) = group.Of(acceleration);
    group.Of(position) = end;
    if (equation.time_step() > 0)
      group.Of(velocity) = rate * (end - group.Of(position_history));
    else
      group.Of(velocity).setZero();
    group.Of(acceleration) = rate * (group.Of(velocity) - group.Of(velocity_history));
  }

  TangentLinearSummary Advance(const MotionHistory& before, TimeScheme scheme, double time_step,
                               const Eigen::VectorXd& at) {
    if (Count() == 0) return {TangentLinearSummary::Status::kSolved, {}};
    const StepEquation equation(model, before, scheme, time_step);
    const StepEquation::EndOfStep end = equation.End(at);
    Assemble(equation, end, at);
    ParallelFor(Count(), 1, [&](int64_t k) { right.col(k) = ParameterForce(equation, end, k); });
    AddMemoryForces(equation, end);
    PlaceGrips(equation, at);
    Eigen::MatrixXd forces;
    if (options.with_reactions) forces.resizeLike(right);
    ForEachGroup(Count(), [&](const ColumnGroup& group) {
      AddHistory(equation, group);
      if (options.with_reactions) group.Of(forces) = group.Of(right);
      SubtractGrips(group);
    });

    TangentLinearSummary summary;
    if (!Solve(equation, at)) {
      summary.status = TangentLinearSummary::Status::kSingular;
      summary.message = fmt::format(
          "at {:.6g} s: the tangent is singular, so that the motion has no derivatives there",
          equation.end_time());
      return summary;
    }
    if (options.with_reactions) reaction = -forces;
    ForEachGroup(Count(), [&](const ColumnGroup& group) { Accept(equation, group); });
    AdvanceMemories(equation, end);
    summary.status = TangentLinearSummary::Status::kSolved;
    return summary;
  }
};

TangentLinear::TangentLinear(const Model& model, std::vector<Perturbation> perturbations,
                             const TangentLinearOptions& options)
    : implementation_(std::make_unique<Implementation>(model, std::move(perturbations), options)) {}
TangentLinear::~TangentLinear() = default;
TangentLinear::TangentLinear(TangentLinear&&) noexcept = default;
TangentLinear& TangentLinear::operator=(TangentLinear&&) noexcept = default;

TangentLinearSummary TangentLinear::Advance(const MotionHistory& before, TimeScheme scheme,
                                            double time_step, const Eigen::VectorXd& position) {
  return implementation_->Advance(before, scheme, time_step, position);
}

const Eigen::MatrixXd& TangentLinear::position() const { return implementation_->position; }
const Eigen::MatrixXd& TangentLinear::velocity() const { return implementation_->velocity; }
const Eigen::MatrixXd& TangentLinear::reaction() const { return implementation_->reaction; }

}  // namespace lacuna
