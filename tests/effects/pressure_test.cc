#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "effects/catalogue.h"
#include "fem/stepper.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"

namespace lacuna {
namespace {

const std::map<std::string, double> kUpperPart{
    {"pressure", 300}, {"point_z", 0.039}, {"normal_x", 0.1}, {"normal_z", 2}};

// A block bent and twisted far from its rest shape.
Eigen::VectorXd Bent(const Body& body) {
  Eigen::VectorXd position(3 * body.NodeCount());
  for (int i = 0; i < body.NodeCount(); ++i) {
    const Eigen::Vector3d X = body.mesh.nodes.col(i);
    const double angle = 12 * X.x();
    position.segment<3>(3 * i) << std::sin(angle) * (0.08 - X.z()),
        X.y() * (1 + 5 * X.z()) + 0.3 * X.x(), -std::cos(angle) * (0.08 - X.z());
  }
  return position;
}

TEST(Pressure, PassesTheEffectChecks) {
  CheckEffect(MakeEffect("pressure", {{"pressure", 300}}).get());
  CheckEffect(MakeEffect("pressure", {{"pressure", -300}}).get());
}

TEST(Pressure, PassesTheEffectChecksOnAPart) {
  CheckEffect(MakeEffect("pressure", kUpperPart).get());
}

TEST(Pressure, HasNoResultantOnAClosedSurface) {
  const auto pressure = MakeEffect("pressure", {{"pressure", 300}});
  for (const int order : {1, 2}) {
    const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.1, 0.03, 0.02}, {5, 2, 1}, order), 1000);
    const Eigen::VectorXd position = Bent(body);
    const Eigen::VectorXd force = ForceAt(*pressure, body, position, 0 * position);
    Eigen::Vector3d sum(0, 0, 0), torque(0, 0, 0);
    for (int i = 0; i < body.NodeCount(); ++i) {
      sum += force.segment<3>(3 * i);
      torque += position.segment<3>(3 * i).cross(force.segment<3>(3 * i));
    }
    // Rounding of some hundred additions.
    EXPECT_LT(sum.norm(), 1e-13 * force.lpNorm<1>());
    EXPECT_LT(torque.norm(), 1e-13 * force.lpNorm<1>());
    EXPECT_GT(force.norm(), 0.01);
  }
}

TEST(Pressure, PressesInwardOnItsPartAloneAndRotatesWithIt) {
  const auto pressure =
      MakeEffect("pressure", {{"pressure", 300}, {"point_z", 0.02}, {"normal_z", 1}});
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  for (const int order : {1, 2}) {
    const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.1, 0.03, 0.02}, {5, 2, 1}, order), 1000);
    const Eigen::VectorXd position = (1.5 * turn * body.mesh.nodes).reshaped();
    const Eigen::Matrix3Xd force =
        ForceAt(*pressure, body, position, 0 * position).reshaped(3, body.NodeCount());
    // −300 Pa on the upper face of 30 cm², which is scaled by 1.5² and rotated.
    const Eigen::Vector3d expected = -300 * 0.003 * 2.25 * turn.col(2);
    EXPECT_LT((force.rowwise().sum() - expected).norm(), 1e-13);
    for (int i = 0; i < body.NodeCount(); ++i) {
      if (body.mesh.nodes(2, i) < 0.019) {
        EXPECT_EQ(force.col(i).norm(), 0);
      }
    }
  }
}

TEST(Pressure, HasADerivativeAtItsNullValue) {
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.1, 0.03, 0.02}, {5, 2, 1}), 1000);
  const Eigen::VectorXd position = Bent(body), zero = 0 * position, state;
  Eigen::VectorXd derivative = zero;
  MakeEffect("pressure", {{"pressure", 0}})
      ->AddParameterDerivative({body, position, zero, zero, 0, 0.01, state}, 0, &derivative);
  const Eigen::VectorXd force =
      ForceAt(*MakeEffect("pressure", {{"pressure", 50}}), body, position, zero);
  EXPECT_LT((50 * derivative - force).norm(), 1e-14 * force.norm());
}

// Under uniform pressure every small-strain body shrinks by p/(3K) in all directions: a patch test,
// which quadratic elements pass only with the consistent loads of their faces.
TEST(Pressure, ShrinksABodyUniformly) {
  constexpr double kYoung = 1e5, kPoisson = 0.4, kPressure = 200;
  constexpr double kBulk = kYoung / (3 * (1 - 2 * kPoisson));
  for (const int order : {1, 2}) {
    const TetMesh mesh = Jittered(BoxMesh({0, 0, 0}, {0.04, 0.03, 0.02}, {3, 3, 2}), 0.01, 0.2, 3);
    const auto body = std::make_shared<Body>(MakeBody(order == 1 ? mesh : ToQuadratic(mesh), 1000));
    const Eigen::VectorXd rest = body->mesh.nodes.reshaped();
    const auto pressure = MakeEffect("pressure", {{"pressure", kPressure}});
    const auto linear =
        MakeEffect("linear", {{"young_modulus", kYoung}, {"poisson_ratio", kPoisson}});
    const Eigen::VectorXd shrunk = (1 - kPressure / (3 * kBulk)) * rest;
    const Eigen::VectorXd load = ForceAt(*pressure, *body, rest, 0 * rest);
    const Eigen::VectorXd elastic = ForceAt(*linear, *body, shrunk, 0 * rest);
    EXPECT_LT((load + elastic).norm(), 1e-11 * load.norm()) << order;

    // On the deformed surface it needs A = (1 − ε)² of the load: ε = p (1 − ε)²/(3K).
    Model held{body, {linear, pressure}, {}};
    held.grips.push_back(
        {NodesWhere(body->mesh, [](const Eigen::Vector3d& X) { return X.norm() < 1e-9; }), {}});
    // A bed of negligible stiffness takes the rotations about the held corner.
    held.effects.push_back(MakeEffect("elastic_support", {{"modulus", 1e-3}}));
    MotionHistory history = RestHistory(held);
    const StepSummary summary = Stepper(held, {}).Equilibrium({}, &history);
    ASSERT_TRUE(summary.IsUsable()) << summary.message;
    double strain = 0;
    for (int k = 0; k < 20; ++k) {
      strain = kPressure * (1 - strain) * (1 - strain) / (3 * kBulk);
    }
    // Steps are solved to 1e-8, and the bed adds a little.
    EXPECT_LT((history.position - (1 - strain) * rest).norm(), 1e-6 * strain * rest.norm());
  }
}

TEST(Pressure, IsReadFromYamlAndRefusesAPartWithoutFaces) {
  const Config config = Config::Parse(
      "effects:\n"
      "  - {type: pressure, pressure: -2 kPa}\n"
      "  - {type: pressure, pressure: 1 Pa, point: [0, 0, 5 cm], normal: [0, 0, 3]}\n"
      "  - {type: pressure, pressure: 1 Pa, normal: [0, 0, 0]}\n",
      "a.yaml");
  const std::vector<Config> items = config.Items("effects");
  Eigen::VectorXd all(7), part(7);
  all << -2000, 0, 0, 0, 0, 0, 0;
  part << 1, 0, 0, 0.05, 0, 0, 3;
  EXPECT_EQ(MakeEffect(items[0])->Parameters(), all);
  EXPECT_EQ(MakeEffect(items[1])->Parameters(), part);
  EXPECT_THROW(MakeEffect(items[2]), InputError);

  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.1, 0.03, 0.02}, {5, 2, 1}), 1000);
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped();
  EXPECT_THROW(ForceAt(*MakeEffect(items[1]), body, rest, 0 * rest), InputError);
}

}  // namespace
}  // namespace lacuna
