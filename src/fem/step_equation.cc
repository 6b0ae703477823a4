#include "fem/step_equation.h"

#include <glog/logging.h>

#include <limits>

namespace lacuna {
namespace {

Eigen::VectorXd RestPosition(const Body& body) {
  return Eigen::Map<const Eigen::VectorXd>(body.mesh.nodes.data(), body.mesh.nodes.size());
}

}  // namespace

MotionHistory RestHistory(const Model& model) {
  MotionHistory history;
  history.position = RestPosition(*model.body);
  history.velocity = Eigen::VectorXd::Zero(history.position.size());
  for (const auto& effect : model.effects) {
    Eigen::VectorXd state(effect->StateSize(*model.body));
    effect->InitialState(*model.body, &state);
    history.effect_state.push_back(std::move(state));
  }
  return history;
}

StepEquation::StepEquation(const Model& model, const MotionHistory& history, TimeScheme scheme,
                           double time_step)
    : model_(model),
      history_(history),
      inertia_(scheme != TimeScheme::kQuasiStatic),
      time_step_(time_step),
      end_time_(history.time + time_step) {
  CHECK_EQ(history.position.size(), 3 * model.body->NodeCount());
  CHECK_EQ(history.effect_state.size(), model.effects.size());
  CHECK(time_step > 0 || (time_step == 0 && !inertia_)) << "a step with inertia needs a length";
  if (time_step == 0) return;
  const int steps_before = history.previous_position.size() == 0
                               ? 0
                               : (history.previous_acceleration.size() == 0 ? 1 : 2);
  weights_ = WeightsOf(scheme, time_step, steps_before, history.previous_time_step);
  position_history_ = weights_.Combine(history.position, history.previous_position,
                                       history.velocity, history.previous_velocity);
  velocity_history_ = weights_.Combine(history.velocity, history.previous_velocity,
                                       history.acceleration, history.previous_acceleration);
}

StepEquation::EndOfStep StepEquation::End(const Eigen::VectorXd& position) const {
  EndOfStep end{position, Velocity(position), {}};
  if (inertia_) {
    end.acceleration = rate() * (end.velocity - velocity_history_);
  } else {
    end.acceleration = Eigen::VectorXd::Zero(position.size());
  }
  return end;
}

Kinematics StepEquation::At(const EndOfStep& end, size_t effect) const {
  return {.body = *model_.body,
          .position = end.position,
          .velocity = end.velocity,
          .acceleration = end.acceleration,
          .time = end_time_,
          .time_step = time_step_,
          .state = history_.effect_state[effect],
          .elasticity = ElasticityOf(model_),
          .has_inertia = inertia_};
}

Eigen::VectorXd StepEquation::Velocity(const Eigen::VectorXd& position) const {
  if (rate() == 0) return Eigen::VectorXd::Zero(position.size());
  return rate() * (position - position_history_);
}

void StepEquation::Residual(const Eigen::VectorXd& position, Eigen::VectorXd* residual,
                            double* force_scale) const {
  const EndOfStep end = End(position);
  // M a, which is 0 in statics.
  *residual =
      (end.acceleration.reshaped(3, model_.body->NodeCount()) * model_.body->node_mass.asDiagonal())
          .reshaped();
  double scale = residual->norm();
  Eigen::VectorXd force(position.size());
  for (size_t j = 0; j < model_.effects.size(); ++j) {
    force.setZero();
    model_.effects[j]->AddForce(At(end, j), &force);
    *residual -= force;
    scale += force.norm();
  }
  if (force_scale != nullptr) *force_scale = scale;
}

TangentWeights StepEquation::Weights() const {
  return {-1, -rate(), inertia_ ? -rate() * rate() : 0};
}

void StepEquation::Tangent(const Eigen::VectorXd& position, bool convexify,
                           BlockMatrix* tangent) const {
  const EndOfStep end = End(position);
  const TangentWeights weights = Weights();
  tangent->SetZero();
  for (size_t j = 0; j < model_.effects.size(); ++j)
    model_.effects[j]->AddTangents(At(end, j), weights, convexify, tangent);
  if (!inertia_) return;
  const Eigen::VectorXd& mass = model_.body->node_mass;
  for (Eigen::Index i = 0; i < mass.size(); ++i) {
    tangent->Block(tangent->pattern().diagonal[i]).diagonal().array() += rate() * rate() * mass[i];
  }
}

bool StepEquation::SkewTangent(const Eigen::VectorXd& position, BlockMatrix* tangent) const {
  const EndOfStep end = End(position);
  const TangentWeights weights = Weights();
  tangent->SetZero();
  bool any = false;
  for (size_t j = 0; j < model_.effects.size(); ++j)
    any |= model_.effects[j]->AddSkewTangents(At(end, j), weights, tangent);
  return any;
}

void StepEquation::AddParameterForce(const EndOfStep& end, int effect, int parameter,
                                     Eigen::VectorXd* force) const {
  model_.effects[effect]->AddParameterDerivative(At(end, effect), parameter, force);
  if (effect != 0) return;
  for (size_t j = 1; j < model_.effects.size(); ++j)
    model_.effects[j]->AddElasticityDerivative(At(end, j), parameter, force);
}

double StepEquation::Potential(const Eigen::VectorXd& position) const {
  const EndOfStep end = End(position);
  double potential = 0;
  if (inertia_) {
    // ½ γ² (x − x̃ − ṽ/γ)ᵀ M (x − x̃ − ṽ/γ), whose gradient is M a.
    const Eigen::VectorXd& mass = model_.body->node_mass;
    for (Eigen::Index i = 0; i < mass.size(); ++i) {
      potential +=
          0.5 * mass[i] *
          (end.velocity.segment<3>(3 * i) - velocity_history_.segment<3>(3 * i)).squaredNorm();
    }
  }
  for (size_t j = 0; j < model_.effects.size(); ++j) {
    const std::optional<double> energy = model_.effects[j]->Energy(At(end, j));
    if (!energy) return std::numeric_limits<double>::quiet_NaN();
    potential += *energy;
  }
  return potential;
}

MotionHistory StepEquation::Advance(const Eigen::VectorXd& position) const {
  const EndOfStep end = End(position);
  MotionHistory next;
  next.time = end_time_;
  next.position = position;
  next.velocity = end.velocity;
  if (time_step_ > 0) {
    if (inertia_) next.acceleration = end.acceleration;
    next.previous_position = history_.position;
    next.previous_velocity = history_.velocity;
    next.previous_acceleration = history_.acceleration;
    next.previous_time_step = time_step_;
  }
  for (size_t j = 0; j < model_.effects.size(); ++j) {
    Eigen::VectorXd state = history_.effect_state[j];
    if (state.size() > 0) model_.effects[j]->AdvanceState(At(end, j), &state);
    next.effect_state.push_back(std::move(state));
  }
  return next;
}

}  // namespace lacuna
