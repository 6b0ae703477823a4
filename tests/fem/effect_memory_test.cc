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

// Without them its sensitivities would be wrong in silence.
TEST(Effect, WithInternalVariablesMustDefineTheirDerivatives) {
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.1, 0.1, 0.1}, {1, 1, 1}), 1000);
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped(), still = 0 * rest;
  const Eigen::VectorXd state = Eigen::VectorXd::Zero(1);
  const Kinematics at{
      .body = body, .position = rest, .velocity = still, .acceleration = still, .state = state};
  const InertiaRecorder recorder;
  Eigen::MatrixXd changes = Eigen::MatrixXd::Zero(1, 1);
  Eigen::MatrixXd nodal = Eigen::MatrixXd::Zero(rest.size(), 1);
  EXPECT_DEATH(recorder.AddStateDerivatives(at, changes, nodal),
               "inertia_recorder.*AddStateDerivatives");
  EXPECT_DEATH(recorder.AdvanceStateDerivatives(at, nodal, changes),
               "inertia_recorder.*AdvanceStateDerivatives");
  EXPECT_DEATH(recorder.AddStateByParameter(at, 0, changes.col(0)),
               "inertia_recorder.*AddStateByParameter");
}

}  // namespace
}  // namespace lacuna
