#include "fem/tangent_linear.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "core/parallel.h"
#include "fem/cholmod_factor.h"
#include "fem/elimination_order.h"
#include "fem/held_components.h"
#include "fem/unsymmetric_factor.h"

namespace lacuna {
namespace {

Eigen::MatrixXd ScaledRows(const Eigen::VectorXd& node_weight, Eigen::MatrixXd columns) {
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    columns.col(k).reshaped(3, node_weight.size()).array().rowwise() *=
        node_weight.transpose().array();
  }
  return columns;
}

// Perturbations are advanced in groups of so many: the columns of a group stay in a core's cache
// from one operation to the next. Fixed, because the iterations of a group end together.
constexpr Eigen::Index kGroup = 16;

// An effect with memory, of the model or of a perturbation.
struct Memory {
  std::shared_ptr<const Effect> effect;
  Eigen::VectorXd value;        // z of an effect outside the model
  Eigen::MatrixXd sensitivity;  // dz/dp of an effect of the model, state × perturbations
};

// The columns of one group.
struct Group {
  Eigen::Index first = 0, count = 0;

  template <typename Matrix>
  auto Of(Matrix& matrix) const {
    return matrix.middleCols(first, count);
  }
};

bool IsZero(const BlockMatrix& matrix) {
  const double* values = matrix.values();
  return std::all_of(values, values + 9 * matrix.pattern().BlockCount(),
                     [](double value) { return value == 0; });
}

}  // namespace

struct TangentLinear::Implementation {
  Model model;
  std::vector<Perturbation> perturbations;
  HeldComponents held;
  EliminationOrder order;
  CholmodFactor factor;
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
  std::vector<Memory> inside;   // one per effect of the model
  std::vector<Memory> outside;  // one per perturbation; unused if its effect is in the model

  Implementation(const Model& the_model, std::vector<Perturbation> the_perturbations,
                 const TangentLinearOptions& the_options)
      : model(the_model),
        perturbations(std::move(the_perturbations)),
        held(HeldAxes(model)),
        order(NestedDissection(*model.body->pattern, held.whole_nodes())),
        factor(*model.body->pattern, order),
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
      inside.push_back(
          {effect, {}, Eigen::MatrixXd::Zero(effect->StateSize(*model.body), Count())});
    }
    for (const Perturbation& perturbation : perturbations) {
      Memory memory;
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

  // Calls visit(group), possibly at the same time for several groups.
  template <typename Visit>
  void ForEachGroup(const Visit& visit) const {
    ParallelBlocks(Count(), kGroup, [&](int64_t begin, int64_t end) {
      visit(Group{begin, static_cast<Eigen::Index>(end - begin)});
    });
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
    return {*model.body,      end.position,        end.velocity,
            end.acceleration, equation.end_time(), equation.time_step(),
            outside[k].value, ElasticityOf(model), equation.has_inertia()};
  }

  // Σ ∂f/∂z ζ over the effects with memory.
  void AddMemoryForces(const StepEquation& equation, const StepEquation::EndOfStep& end) {
    for (size_t j = 0; j < inside.size(); ++j) {
      const Eigen::MatrixXd& change = inside[j].sensitivity;
      if (change.rows() == 0 || change.isZero(0)) continue;
      const Kinematics at = equation.At(end, j);
      ForEachGroup([&](const Group& group) {
        inside[j].effect->AddStateDerivatives(at, group.Of(change), group.Of(right));
      });
    }
  }

  // dz/dp at the end of the step, from the sensitivities there.
  void AdvanceMemories(const StepEquation& equation, const StepEquation::EndOfStep& end) {
    for (size_t j = 0; j < inside.size(); ++j) {
      Memory& memory = inside[j];
      if (memory.sensitivity.rows() == 0) continue;
      const Kinematics at = equation.At(end, j);
      ForEachGroup([&](const Group& group) {
        memory.effect->AdvanceStateDerivatives(at, group.Of(position),
                                               group.Of(memory.sensitivity));
        for (Eigen::Index k = group.first; k < group.first + group.count; ++k)
          if (perturbations[k].effect == memory.effect)
            memory.effect->AddStateByParameter(at, perturbations[k].parameter,
                                               memory.sensitivity.col(k));
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
      return !IsZero(*matrix);
    };
    has_velocity = assemble({.velocity = equation.rate()}, &by_velocity);
    has_acceleration = assemble({.acceleration = 1}, &by_acceleration);
  }

  // The part of the right-hand side that earlier sensitivities make.
  void AddHistory(const StepEquation& equation, const Group& group) {
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
      held.Copy(change, &own);
      moved.col(k) = own;
    }
  }

  void SubtractGrips(const Group& group) {
    const Eigen::MatrixXd gripped = group.Of(moved);
    if (gripped.isZero(0)) return;
    group.Of(right) -= tangent * gripped;
    if (has_skew) group.Of(right) -= skew * gripped;
  }

  // Solves (tangent + skew) · s = right at the free nodes with the factor of the tangent. No value
  // if the iteration does not converge.
  std::optional<Eigen::MatrixXd> SolveByTangent(const Group& group) {
    Eigen::MatrixXd wanted = group.Of(right);
    if (!has_skew) return SolveFree(factor, order, held, wanted);
    held.ClearIn(wanted);
    // The contribution of the skew part changes little from one step to the next.
    Eigen::MatrixXd expected = 2 * group.Of(position) - group.Of(previous_position);
    return Iterate(wanted, wanted - skew * expected,
                   [&](const Eigen::MatrixXd& step, Eigen::MatrixXd* residual) {
                     *residual = skew * (expected - step);
                     expected.setZero();
                   });
  }

  // Solves (tangent + skew) · s = right at the free nodes with the factor of the convexified
  // approximation.
  std::optional<Eigen::MatrixXd> SolveByStandIn(const Group& group) {
    Eigen::MatrixXd wanted = group.Of(right);
    held.ClearIn(wanted);
    return Iterate(wanted, wanted, [&](const Eigen::MatrixXd& step, Eigen::MatrixXd* residual) {
      *residual -= tangent * step;
      if (has_skew) *residual -= skew * step;
    });
  }

  // Iterative refinement: adds solutions for the residual until it is small relative to the
  // right-hand side. update(step, &residual) computes the residual after a step.
  template <typename Update>
  std::optional<Eigen::MatrixXd> Iterate(const Eigen::MatrixXd& wanted, Eigen::MatrixXd residual,
                                         const Update& update) {
    constexpr int kMaxIterations = 60;
    const Eigen::RowVectorXd small = options.tolerance * wanted.colwise().norm();
    Eigen::MatrixXd solution = Eigen::MatrixXd::Zero(wanted.rows(), wanted.cols());
    held.ClearIn(residual);
    double last = residual.norm();
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
      const Eigen::MatrixXd step = SolveFree(factor, order, held, residual);
      solution += step;
      update(step, &residual);
      held.ClearIn(residual);
      if ((residual.colwise().norm().array() <= small.array()).all()) return solution;
      if (!(residual.norm() < 2 * last)) break;
      last = residual.norm();
    }
    return std::nullopt;
  }

  // Solves (tangent + skew) · s = right at the free nodes with the factor of the whole matrix. No
  // value if the residual exceeds the tolerance.
  std::optional<Eigen::MatrixXd> SolveByWhole(const UnsymmetricFactor& whole, const Group& group) {
    Eigen::MatrixXd wanted = group.Of(right);
    held.ClearIn(wanted);
    const Eigen::MatrixXd solution = whole.Solve(wanted);
    Eigen::MatrixXd residual = wanted - tangent * solution;
    if (has_skew) residual -= skew * solution;
    held.ClearIn(residual);
    const Eigen::RowVectorXd small = options.tolerance * wanted.colwise().norm();
    if ((residual.colwise().norm().array() <= small.array()).all()) return solution;
    return std::nullopt;
  }

  // Adds the solution at the free nodes to `moved`. Uses the factor of the tangent's symmetric part
  // or, if that is not definite or the iteration does not converge, that of its convexified
  // approximation. Where that does not converge either, it uses the factor of the whole tangent.
  bool Solve(const StepEquation& equation, const Eigen::VectorXd& at) {
    std::vector<char> solved(static_cast<size_t>((Count() + kGroup - 1) / kGroup), 0);
    const auto add = [&](const Group& group, const std::optional<Eigen::MatrixXd>& solution) {
      if (!solution) return;
      group.Of(moved) += *solution;
      solved[static_cast<size_t>(group.first / kGroup)] = 1;
    };
    if (factor.Factorise(held.Decoupled(tangent)))
      ForEachGroup([&](const Group& group) { add(group, SolveByTangent(group)); });
    const auto is_solved = [&] { return std::count(solved.begin(), solved.end(), 0) == 0; };
    if (is_solved()) return true;
    BlockMatrix stand_in(model.body->pattern);
    equation.Tangent(at, /*convexify=*/true, &stand_in);
    const auto for_unsolved = [&](const auto& solve) {
      ForEachGroup([&](const Group& group) {
        if (!solved[static_cast<size_t>(group.first / kGroup)]) add(group, solve(group));
      });
    };
    if (factor.Factorise(held.Decoupled(stand_in)))
      for_unsolved([&](const Group& group) { return SolveByStandIn(group); });
    if (is_solved()) return true;
    const UnsymmetricFactor whole(held, tangent, has_skew ? &skew : nullptr);
    if (whole.IsUsable())
      for_unsolved([&](const Group& group) { return SolveByWhole(whole, group); });
    return is_solved();
  }

  // Makes the end of the step the current time.
  void Accept(const StepEquation& equation, const Group& group) {
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
    ForEachGroup([&](const Group& group) {
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
    ForEachGroup([&](const Group& group) { Accept(equation, group); });
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
