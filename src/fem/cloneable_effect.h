// Gives an effect its WithParameters().
#ifndef LACUNA_FEM_CLONEABLE_EFFECT_H_
#define LACUNA_FEM_CLONEABLE_EFFECT_H_

#include <Eigen/Core>
#include <memory>

#include "fem/effect.h"

namespace lacuna {

// The base of a class that can be copied and has a SetParameters(values):
//   class DragEffect final : public CloneableEffect<DragEffect> { … };
// Only the new copy, which is not shared yet, is changed. `Base` is Effect or a class derived from
// it.
template <typename Derived, typename Base = Effect>
class CloneableEffect : public Base {
 public:
  std::shared_ptr<const Effect> WithParameters(const Eigen::VectorXd& values) const final {
    const auto copy = std::make_shared<Derived>(static_cast<const Derived&>(*this));
    copy->SetParameters(values);
    return copy;
  }
};

}  // namespace lacuna

#endif  // LACUNA_FEM_CLONEABLE_EFFECT_H_
