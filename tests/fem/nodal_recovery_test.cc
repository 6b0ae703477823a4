#include "fem/nodal_recovery.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <memory>

#include "effects/catalogue.h"
#include "fem/step_equation.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

Model Block(int order, const EffectList& effects) {
  Model model;
  const TetMesh mesh = Jittered(BoxMesh({0, 0, 0}, {0.04, 0.03, 0.02}, {4, 3, 2}), 0.01, 0.2, 5);
  model.body = std::make_shared<const Body>(MakeBody(order == 1 ? mesh : ToQuadratic(mesh), 1000));
  model.effects = effects;
  return model;
}

NodalStress At(const Model& model, const Eigen::Matrix3Xd& position) {
  const MotionHistory rest = RestHistory(model);
  return RecoverNodalStress(model, position.reshaped(), Eigen::VectorXd::Zero(position.size()), 0,
                            rest.effect_state);
}

// Of a uniform deformation F all nodes have the same stress: σ = (μ (F − cof F) + …) Fᵀ/J, here
// from the formula of the law (effects/neo_hookean.cc).
TEST(NodalRecovery, IsExactForUniformDeformation) {
  const double young = 1e5, nu = 0.3;
  const double mu = young / (2 * (1 + nu)), lambda = young * nu / ((1 + nu) * (1 - 2 * nu));
  const Eigen::Matrix3d F{{1.2, 0.1, 0}, {-0.05, 0.9, 0.2}, {0, 0.1, 1.05}};
  const double J = F.determinant();
  const Eigen::Matrix3d P = mu * F + ((lambda + mu) * (J - 1) - mu) * J * F.inverse().transpose();
  const Eigen::Matrix3d sigma = P * F.transpose() / J;
  const Eigen::Vector3d stretch = F.jacobiSvd().singularValues();
  for (const int order : {1, 2}) {
    const Model model = Block(
        order, {MakeEffect("neo_hookean", {{"young_modulus", young}, {"poisson_ratio", nu}})});
    const NodalStress stress = At(model, F * model.body->mesh.nodes);
    for (int node = 0; node < model.body->NodeCount(); ++node) {
      const Eigen::Matrix<double, 6, 1> s = stress.cauchy.col(node);
      const Eigen::Matrix3d tensor{{s[0], s[5], s[4]}, {s[5], s[1], s[3]}, {s[4], s[3], s[2]}};
      ASSERT_LT((tensor - sigma).norm(), 1e-9 * sigma.norm());
      ASSERT_LT((stress.stretch.col(node) - stretch).norm(), 1e-12);
      const Eigen::Matrix3d deviator = sigma - sigma.trace() / 3 * Eigen::Matrix3d::Identity();
      ASSERT_NEAR(stress.von_mises[node], std::sqrt(1.5) * deviator.norm(), 1e-6 * young);
    }
  }
}

// The linear stress of a quadratic displacement reaches the nodes of quadratic elements exactly,
// those at the boundary too.
TEST(NodalRecovery, IsExactForLinearStressInQuadraticElements) {
  const double young = 1e5;
  const Model model =
      Block(2, {MakeEffect("linear", {{"young_modulus", young}, {"poisson_ratio", 0}})});
  const Eigen::Matrix3Xd& rest = model.body->mesh.nodes;
  Eigen::Matrix3Xd position = rest;
  constexpr double kRate = 1e-4;  // strain per m
  position.row(0).array() += 0.5 * kRate * rest.row(0).array().square();
  const NodalStress stress = At(model, position);
  for (int node = 0; node < model.body->NodeCount(); ++node)
    ASSERT_NEAR(stress.cauchy(0, node), young * kRate * rest(0, node), 1e-4 * young * kRate * 0.04);
}

TEST(NodalRecovery, OfVonMisesIsTheUniaxialStress) {
  EXPECT_DOUBLE_EQ(VonMises((Eigen::Matrix<double, 6, 1>() << 0, -5, 0, 0, 0, 0).finished()), 5);
  EXPECT_NEAR(VonMises((Eigen::Matrix<double, 6, 1>() << 3, 3, 3, 0, 0, 0).finished()), 0, 1e-12);
  EXPECT_NEAR(VonMises((Eigen::Matrix<double, 6, 1>() << 0, 0, 0, 0, 2, 0).finished()),
              2 * std::sqrt(3.0), 1e-12);
}

// An effect that is relieved by its deformation leaves no stress; a load is none.
TEST(NodalRecovery, SumsTheEffectsThatAreStresses) {
  const EffectList elastic{
      MakeEffect("neo_hookean", {{"young_modulus", 1e5}, {"poisson_ratio", 0.3}})};
  EffectList swollen = elastic;
  swollen.push_back(MakeEffect("swelling", {{"strain", 0.1}}));
  swollen.push_back(MakeEffect(
      "gravity", {{"acceleration_x", 0}, {"acceleration_y", 0}, {"acceleration_z", -9.81}}));
  const Model model = Block(1, swollen);
  const NodalStress free = At(model, 1.1 * model.body->mesh.nodes);
  EXPECT_LT(free.cauchy.cwiseAbs().maxCoeff(), 1e-8 * 1e5);
  const NodalStress held = At(model, model.body->mesh.nodes);
  EXPECT_LT(held.cauchy(0, 0), -0.05 * 1e5) << "compressed";
}

}  // namespace
}  // namespace lacuna
