// The base of effects that a test defines.
#ifndef LACUNA_TESTS_SUPPORT_TEST_EFFECT_H_
#define LACUNA_TESTS_SUPPORT_TEST_EFFECT_H_

#include "fem/cloneable_effect.h"

namespace lacuna {

// An effect without parameters that does nothing; a test overrides what it is about. `Derived` has
// a name, the type in its card:
//   class Push final : public TestEffect<Push> {
//    public:
//     static constexpr const char* kType = "push";
template <typename Derived>
class TestEffect : public CloneableEffect<Derived> {
 public:
  const EffectCard& Card() const override {
    static const EffectCard card = [] {
      EffectCard own;
      own.type = Derived::kType;
      return own;
    }();
    return card;
  }
  Eigen::VectorXd Parameters() const override { return {}; }
  void SetParameters(const Eigen::VectorXd&) {}
  void AddForce(const Kinematics&, Eigen::VectorXd*) const override {}
  void AddTangents(const Kinematics&, const TangentWeights&, bool, BlockMatrix*) const override {}
  void AddParameterDerivative(const Kinematics&, int, Eigen::VectorXd*) const override {}
};

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_TEST_EFFECT_H_
