// The internal variables of the effects of a model along a trajectory that was predicted before.
//
// They are advanced from one visited state to the next. Where these are farther apart than the
// steps of the prediction, the strain is taken to be linear in between.
#ifndef LACUNA_FEM_EFFECT_MEMORY_H_
#define LACUNA_FEM_EFFECT_MEMORY_H_

#include <Eigen/Core>
#include <vector>

#include "fem/model.h"
#include "fem/time_scheme.h"

namespace lacuna {

// Keeps a reference to the model, which must outlive it.
class EffectMemory {
 public:
  // `scheme`: that of the prediction.
  EffectMemory(const Model& model, TimeScheme scheme);

  // Whether any effect has internal variables.
  bool IsEmpty() const;

  // The internal variables of each effect at a state (3n, m and m/s) at `time` (s) that follows the
  // last one after `time_step` s; 0 for the equilibrium before the motion.
  const std::vector<Eigen::VectorXd>& Advance(const Eigen::VectorXd& position,
                                              const Eigen::VectorXd& velocity, double time,
                                              double time_step);

 private:
  const Model& model_;
  bool has_inertia_;  // of the steps of the motion
  std::vector<Eigen::VectorXd> state_;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_EFFECT_MEMORY_H_
