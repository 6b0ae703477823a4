// The example in the header of the interface, used in a simulation.
#include "fem/effect.h"

#include <gtest/gtest.h>

#include <memory>

#include "fem/cloneable_effect.h"
#include "fem/stepper.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

const EffectCard& LiftCard() {
  static const EffectCard card = [] {
    EffectCard lift;
    lift.type = "lift";
    lift.title = "Uniform lift";
    lift.equation = "f_i = a m_i e_z";
    ParameterCard& acceleration = lift.parameters.emplace_back();
    acceleration.name = "acceleration";
    acceleration.meaning = "a";
    return lift;
  }();
  return card;
}

class Lift final : public CloneableEffect<Lift> {
 public:
  const EffectCard& Card() const override { return LiftCard(); }
  Eigen::VectorXd Parameters() const override { return Eigen::VectorXd::Constant(1, a_); }
  void SetParameters(const Eigen::VectorXd& values) { a_ = values[0]; }
  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    force->reshaped(3, at.body.NodeCount()).row(2) += a_ * at.body.node_mass.transpose();
  }
  void AddTangents(const Kinematics&, const TangentWeights&, bool, BlockMatrix*) const override {}
  void AddParameterDerivative(const Kinematics& at, int, Eigen::VectorXd* f) const override {
    f->reshaped(3, at.body.NodeCount()).row(2) += at.body.node_mass.transpose();
  }

 private:
  double a_ = 0;
};

TEST(Effect, TheExampleOfTheHeaderAcceleratesAFreeBody) {
  constexpr double kAcceleration = 3, kTimeStep = 0.01;  // m/s², s
  constexpr int kSteps = 5;
  const auto lift = Lift().WithParameters(Eigen::VectorXd::Constant(1, kAcceleration));
  Model model;
  model.body =
      std::make_shared<const Body>(MakeBody(BoxMesh({0, 0, 0}, {0.1, 0.1, 0.1}, {1, 1, 1}), 1000));
  model.effects = {lift};
  Stepper stepper(model, {});
  MotionHistory history = RestHistory(model);
  for (int step = 0; step < kSteps; ++step)
    ASSERT_TRUE(stepper.Step(kTimeStep, {}, &history).IsUsable());
  // A constant acceleration is integrated exactly, up to the tolerance of Newton's method.
  const auto velocity = history.velocity.reshaped(3, model.body->NodeCount());
  const double expected = kAcceleration * kSteps * kTimeStep;
  EXPECT_LT((velocity.row(2).array() - expected).abs().maxCoeff(), 1e-6 * expected);
  EXPECT_LT(velocity.topRows(2).norm(), 1e-6 * expected);
}

}  // namespace
}  // namespace lacuna
