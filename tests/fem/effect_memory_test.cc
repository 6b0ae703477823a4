#include "fem/effect_memory.h"

#include <gtest/gtest.h>

#include <memory>

#include "support/box_mesh.h"
#include "support/test_effect.h"

namespace lacuna {
namespace {

// Its internal variable says whether the last step had inertia.
class InertiaRecorder final : public TestEffect<InertiaRecorder> {
 public:
  static constexpr const char* kType = "inertia_recorder";
  Eigen::Index StateSize(const Body&) const override { return 1; }
  void InitialState(const Body&, Eigen::VectorXd* state) const override { state->setZero(); }
  void AdvanceState(const Kinematics& at, Eigen::VectorXd* state_at_end) const override {
    (*state_at_end)[0] = at.has_inertia ? 1 : 0;
  }
};

// The equilibrium before a motion has no inertia either.
TEST(EffectMemory, AdvancesWithTheInertiaOfTheMotion) {
  Model model;
  model.body =
      std::make_shared<const Body>(MakeBody(BoxMesh({0, 0, 0}, {0.1, 0.1, 0.1}, {1, 1, 1}), 1000));
  model.effects = {std::make_shared<const InertiaRecorder>()};
  const Eigen::VectorXd rest = model.body->mesh.nodes.reshaped();
  for (const TimeScheme scheme : {TimeScheme::kTwoStep, TimeScheme::kQuasiStatic}) {
    EffectMemory memory(model, scheme);
    EXPECT_FALSE(memory.IsEmpty());
    EXPECT_EQ(memory.Advance(rest, 0 * rest, 0, 0)[0][0], 0);
    EXPECT_EQ(memory.Advance(rest, 0 * rest, 0.01, 0.01)[0][0],
              scheme == TimeScheme::kQuasiStatic ? 0 : 1);
  }
}

}  // namespace
}  // namespace lacuna
