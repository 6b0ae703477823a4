#include "fem/tangent_linear.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "fem/cholmod_factor.h"
#include "fem/elimination_order.h"

namespace lacuna {
namespace {

// Internal variables are differentiated by differences of this size, in strains. Rounding errors
// are then 1e-10 of the value and truncation errors 1e-6 of its second derivative; most forces are
// linear in the internal variables.
constexpr double kDifference = 1e-6;

Eigen::MatrixXd ScaledRows(const Eigen::VectorXd& node_weight, Eigen::MatrixXd columns) {
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    columns.col(k).reshaped(3, node_weight.size()).array().rowwise() *=
        node_weight.transpose().array();
  }
  return columns;
}

// An effect with memory, of the model or of a perturbation.
struct Memory {
  std::shared_ptr<const Effect> effect;
  Eigen::VectorXd value;        // z of an effect outside the model
  Eigen::MatrixXd sensitivity;  // dz/dp of an effect of the model, state × perturbations
};

}  // namespace

struct TangentLinear::Implementation {
  Model model;
  std::vector<Perturbation> perturbations;
  std::vector<char> fixed;
  EliminationOrder order;
  CholmodFactor factor;
  BlockMatrix tangent, skew, rate_tangent;
  std::vector<Eigen::Index> of_grips;  // perturbations of the motion of grips
  double element_size;                 // m
  TangentLinearOptions options;
  // Sensitivities at the current time and one step earlier.
  Eigen::MatrixXd position, velocity, acceleration;
  Eigen::MatrixXd previous_position, previous_velocity, previous_acceleration;
  Eigen::MatrixXd reaction;     // at the current time
  std::vector<Memory> inside;   // one per effect of the model
  std::vector<Memory> outside;  // one per perturbation; unused if its effect is in the model

  Implementation(const Model& the_model, std::vector<Perturbation> the_perturbations,
                 const TangentLinearOptions& the_options)
      : model(the_model),
        perturbations(std::move(the_perturbations)),
        fixed(GrippedNodes(model)),
        order(NestedDissection(*model.body->pattern, fixed)),
        factor(*model.body->pattern, order),
        tangent(model.body->pattern),
        skew(model.body->pattern),
        rate_tangent(model.body->pattern),
        element_size(std::cbrt(model.body->weight.sum() / model.body->ElementCount())),
        options(the_options) {
    const Eigen::Index size = 3 * model.body->NodeCount();
    position = velocity = reaction = Eigen::MatrixXd::Zero(size, Count());
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
    for (Eigen::Index k = 0; k < Count(); ++k)
      if (perturbations[k].grip) of_grips.push_back(k);
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
    return {*model.body,         end.position,         end.velocity,     end.acceleration,
            equation.end_time(), equation.time_step(), outside[k].value, ElasticityOf(model)};
  }

  // Σ ∂f/∂z ζ over the effects with memory.
  void AddMemoryForces(const StepEquation& equation, const StepEquation::EndOfStep& end,
                       Eigen::MatrixXd* right) const {
    Eigen::VectorXd plus(end.position.size()), now(end.position.size());
    for (size_t j = 0; j < inside.size(); ++j) {
      const Eigen::MatrixXd& change = inside[j].sensitivity;
      if (change.rows() == 0) continue;
      if (change.isZero(0)) continue;
      const Kinematics at = equation.At(end, j);
      now.setZero();
      inside[j].effect->AddForce(at, &now);
      for (Eigen::Index k = 0; k < Count(); ++k) {
        const double largest = change.col(k).lpNorm<Eigen::Infinity>();
        if (largest == 0) continue;
        const double h = kDifference / largest;
        const Eigen::VectorXd more = at.state + h * change.col(k);
        plus.setZero();
        inside[j].effect->AddForce(WithState(at, more), &plus);
        right->col(k) += (plus - now) / h;
      }
    }
  }

  static Kinematics WithState(const Kinematics& at, const Eigen::VectorXd& state) {
    return {at.body, at.position,  at.velocity, at.acceleration,
            at.time, at.time_step, state,       at.elasticity};
  }

  // dz/dp at the end of the step, from the sensitivities there.
  void AdvanceMemories(const StepEquation& equation, const StepEquation::EndOfStep& end,
                       const Eigen::MatrixXd& s, const Eigen::MatrixXd& w) {
    for (size_t j = 0; j < inside.size(); ++j) {
      Memory& memory = inside[j];
      if (memory.sensitivity.rows() == 0) continue;
      const Kinematics at = equation.At(end, j);
      Eigen::VectorXd now = at.state;
      const Eigen::VectorXd parameters = memory.effect->Parameters();
      memory.effect->AdvanceState(at, parameters, &now);
      for (Eigen::Index k = 0; k < Count(); ++k) {
        const bool own = perturbations[k].effect == memory.effect;
        const double own_value = own ? parameters[perturbations[k].parameter] : 1;
        const double largest = std::max({s.col(k).lpNorm<Eigen::Infinity>() / element_size,
                                         memory.sensitivity.col(k).lpNorm<Eigen::Infinity>(),
                                         own ? 1 / std::max(std::abs(own_value), 1e-300) : 0.0});
        if (largest == 0) continue;
        const double h = kDifference / largest;
        const auto state_at = [&](double shift) {
          const Eigen::VectorXd x = at.position + shift * s.col(k);
          const Eigen::VectorXd v = at.velocity + shift * w.col(k);
          const Eigen::VectorXd z = at.state + shift * memory.sensitivity.col(k);
          Eigen::VectorXd result = z, shifted = parameters;
          if (own) shifted[perturbations[k].parameter] += shift;
          memory.effect->AdvanceState(
              {at.body, x, v, at.acceleration, at.time, at.time_step, z, at.elasticity}, shifted,
              &result);
          return result;
        };
        memory.sensitivity.col(k) = (state_at(h) - now) / h;
      }
    }
    for (Eigen::Index k = 0; k < Count(); ++k) {
      if (outside[k].value.size() == 0) continue;
      const Eigen::VectorXd before = outside[k].value;
      const Kinematics at = AtOutside(equation, end, k);
      outside[k].effect->AdvanceState(WithState(at, before), outside[k].effect->Parameters(),
                                      &outside[k].value);
    }
  }

  // Subtracts the weighted tangents of the effects times `change`. Most effects depend on the
  // position only and contribute nothing.
  void AddTangentForces(const StepEquation& equation, const StepEquation::EndOfStep& end,
                        const TangentWeights& weights, const Eigen::MatrixXd& change,
                        Eigen::MatrixXd* right) {
    rate_tangent.SetZero();
    for (size_t j = 0; j < model.effects.size(); ++j) {
      const Kinematics at = equation.At(end, j);
      model.effects[j]->AddTangents(at, weights, false, &rate_tangent);
      model.effects[j]->AddSkewTangents(at, weights, &rate_tangent);
    }
    const double* values = rate_tangent.values();
    if (std::all_of(values, values + 9 * model.body->pattern->BlockCount(),
                    [](double value) { return value == 0; }))
      return;
    *right -= rate_tangent * change;
  }

  // The sensitivities of the gripped nodes; 0 elsewhere.
  Eigen::MatrixXd GripColumns(const StepEquation& equation, const Eigen::VectorXd& at) const {
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(position.rows(), Count());
    Eigen::VectorXd reaction;
    for (const Eigen::Index k : of_grips) {
      if (reaction.size() == 0) equation.Residual(at, &reaction);
      const Eigen::VectorXd moved = perturbations[k].grip(equation.end_time(), reaction);
      for (size_t i = 0; i < fixed.size(); ++i)
        if (fixed[i]) columns.col(k).segment<3>(3 * i) = moved.segment<3>(3 * i);
    }
    return columns;
  }

  // Solves tangent · s = right at the free nodes with the current factor; s is 0 at fixed nodes.
  Eigen::MatrixXd SolveFree(const Eigen::MatrixXd& right) {
    Eigen::MatrixXd reduced(3 * order.FreeNodes(), right.cols()), solution;
    for (int i = 0; i < order.FreeNodes(); ++i)
      reduced.middleRows<3>(3 * i) = right.middleRows<3>(3 * order.node[i]);
    factor.Solve(reduced, &solution);
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(right.rows(), right.cols());
    for (int i = 0; i < order.FreeNodes(); ++i)
      all.middleRows<3>(3 * order.node[i]) = solution.middleRows<3>(3 * i);
    return all;
  }

  void ClearFixed(Eigen::MatrixXd* columns) const {
    for (size_t i = 0; i < fixed.size(); ++i)
      if (fixed[i]) columns->middleRows<3>(3 * static_cast<Eigen::Index>(i)).setZero();
  }

  // Solves (tangent + skew) · s = right at the free nodes. Factorises the symmetric part or, if
  // that is not definite or the iteration does not converge, its convexified approximation.
  std::optional<Eigen::MatrixXd> Solve(const StepEquation& equation, const Eigen::VectorXd& at,
                                       bool has_skew, Eigen::MatrixXd right) {
    const bool is_definite = factor.Factorise(tangent);
    if (is_definite && !has_skew) return SolveFree(right);
    ClearFixed(&right);
    if (is_definite) {
      // The contribution of the skew part changes little from one step to the next.
      Eigen::MatrixXd expected = position;
      if (previous_position.size() > 0) expected += position - previous_position;
      const auto solution = Iterate(right, right - skew * expected,
                                    [&](const Eigen::MatrixXd& step, Eigen::MatrixXd* residual) {
                                      *residual = skew * (expected - step);
                                      expected.setZero();
                                    });
      if (solution) return solution;
    }
    BlockMatrix stand_in(model.body->pattern);
    equation.Tangent(at, /*convexify=*/true, &stand_in);
    if (!factor.Factorise(stand_in)) return std::nullopt;
    return Iterate(right, right, [&](const Eigen::MatrixXd& step, Eigen::MatrixXd* residual) {
      *residual -= tangent * step;
      if (has_skew) *residual -= skew * step;
    });
  }

  // Iterative refinement: adds solutions for the residual until it is small relative to the
  // right-hand side. update(step, &residual) computes the residual after a step.
  template <typename Update>
  std::optional<Eigen::MatrixXd> Iterate(const Eigen::MatrixXd& right, Eigen::MatrixXd residual,
                                         const Update& update) {
    constexpr int kMaxIterations = 60;
    const Eigen::RowVectorXd wanted = options.tolerance * right.colwise().norm();
    Eigen::MatrixXd solution = Eigen::MatrixXd::Zero(right.rows(), right.cols());
    ClearFixed(&residual);
    double last = residual.norm();
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
      const Eigen::MatrixXd step = SolveFree(residual);
      solution += step;
      update(step, &residual);
      ClearFixed(&residual);
      if ((residual.colwise().norm().array() <= wanted.array()).all()) return solution;
      if (!(residual.norm() < 2 * last)) break;
      last = residual.norm();
    }
    return std::nullopt;
  }

  TangentLinearSummary Advance(const MotionHistory& before, TimeScheme scheme, double time_step,
                               const Eigen::VectorXd& at) {
    if (Count() == 0) return {TangentLinearSummary::Status::kSolved, {}};
    const StepEquation equation(model, before, scheme, time_step);
    const StepEquation::EndOfStep end = equation.End(at);
    const double rate = equation.rate();
    const SchemeWeights& weights = equation.weights();
    const Eigen::MatrixXd position_history =
        weights.Combine(position, previous_position, velocity, previous_velocity);
    const Eigen::MatrixXd velocity_history =
        weights.Combine(velocity, previous_velocity, acceleration, previous_acceleration);

    equation.Tangent(at, /*convexify=*/false, &tangent);
    const bool has_skew = equation.SkewTangent(at, &skew);
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(position.rows(), Count());
    for (Eigen::Index k = 0; k < Count(); ++k) right.col(k) = ParameterForce(equation, end, k);
    AddMemoryForces(equation, end, &right);
    if (rate != 0) {
      const Eigen::MatrixXd carried =
          equation.has_inertia()
              ? Eigen::MatrixXd(rate * rate * position_history + rate * velocity_history)
              : Eigen::MatrixXd::Zero(position.rows(), Count());
      right += ScaledRows(model.body->node_mass, carried);
      AddTangentForces(equation, end, {.velocity = rate}, position_history, &right);
      AddTangentForces(equation, end, {.acceleration = 1}, carried, &right);
    }
    if (options.with_reactions) reaction = -right;
    const Eigen::MatrixXd gripped = GripColumns(equation, at);
    if (!of_grips.empty()) {
      const Eigen::MatrixXd moved = gripped(Eigen::all, of_grips);
      right(Eigen::all, of_grips) -= tangent * moved;
      if (has_skew) right(Eigen::all, of_grips) -= skew * moved;
    }

    TangentLinearSummary summary;
    const std::optional<Eigen::MatrixXd> solution = Solve(equation, at, has_skew, std::move(right));
    if (!solution) {
      summary.status = TangentLinearSummary::Status::kNotPositiveDefinite;
      summary.message = fmt::format(
          "at {:.6g} s: the tangent is not positive definite, and the iteration with its "
          "convexified approximation does not converge",
          equation.end_time());
      return summary;
    }
    const Eigen::MatrixXd moved = *solution + gripped;
    const Eigen::MatrixXd speed = time_step > 0 ? Eigen::MatrixXd(rate * (moved - position_history))
                                                : Eigen::MatrixXd::Zero(moved.rows(), moved.cols());
    if (options.with_reactions) reaction += tangent * moved;
    if (options.with_reactions && has_skew) reaction += skew * moved;
    AdvanceMemories(equation, end, moved, speed);
    previous_position = std::move(position);
    previous_velocity = std::move(velocity);
    previous_acceleration = std::move(acceleration);
    position = moved;
    velocity = speed;
    acceleration = rate * (velocity - velocity_history);
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
