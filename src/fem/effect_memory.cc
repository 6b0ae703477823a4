#include "fem/effect_memory.h"

#include <algorithm>

#include "fem/step_equation.h"

namespace lacuna {

EffectMemory::EffectMemory(const Model& model, TimeScheme scheme)
    : model_(model),
      has_inertia_(scheme != TimeScheme::kQuasiStatic),
      state_(RestHistory(model).effect_state) {}

bool EffectMemory::IsEmpty() const {
  return std::all_of(state_.begin(), state_.end(),
                     [](const Eigen::VectorXd& state) { return state.size() == 0; });
}

const std::vector<Eigen::VectorXd>& EffectMemory::Advance(const Eigen::VectorXd& position,
                                                          const Eigen::VectorXd& velocity,
                                                          double time, double time_step) {
  const Eigen::VectorXd no_acceleration = Eigen::VectorXd::Zero(position.size());
  for (size_t j = 0; j < state_.size(); ++j) {
    if (state_[j].size() == 0) continue;
    const Eigen::VectorXd before = state_[j];
    model_.effects[j]->AdvanceState({.body = *model_.body,
                                     .position = position,
                                     .velocity = velocity,
                                     .acceleration = no_acceleration,
                                     .time = time,
                                     .time_step = time_step,
                                     .state = before,
                                     .elasticity = ElasticityOf(model_),
                                     .has_inertia = has_inertia_ && time_step > 0},
                                    &state_[j]);
  }
  return state_;
}

}  // namespace lacuna
