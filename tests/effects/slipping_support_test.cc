#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "effects/catalogue.h"
#include "fem/stepper.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"

namespace lacuna {
namespace {

constexpr double kModulus = 1e6;    // Pa/m
constexpr double kDistance = 1e-3;  // m
const Eigen::Vector3d kSize(0.03, 0.02, 0.04);

double Surface() {
  return 2 * (kSize.x() * kSize.y() + kSize.y() * kSize.z() + kSize.z() * kSize.x());
}

TEST(SlippingSupport, PassesTheEffectChecks) {
  // A body rotated by one radian is displaced by some centimetres: first some nodes hold and others
  // slide, then all slide.
  for (const double distance : {0.03, 0.002}) {
    CheckEffect(
        MakeEffect("slipping_support", {{"modulus", 1e5}, {"slip_distance", distance}}).get(),
        {.without_influence = {"point_x", "point_y", "point_z", "radius"}});
    CheckEffect(MakeEffect("slipping_support", {{"modulus", 1e5},
                                                {"slip_distance", distance},
                                                {"point_x", 0.02},
                                                {"point_y", -0.01},
                                                {"point_z", 0.03},
                                                {"side_x", 1},
                                                {"radius", 0.02}})
                    .get());
  }
}

TEST(SlippingSupport, HoldsAndSlidesAlongALoop) {
  const auto support =
      MakeEffect("slipping_support", {{"modulus", kModulus}, {"slip_distance", kDistance}});
  const Body body = MakeBody(BoxMesh({0, 0, 0}, kSize, {3, 2, 4}), 1000);
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped(), still = 0 * rest;
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 2) / 3;
  Eigen::VectorXd state;
  support->InitialState(body, &state);
  double slip = 0;
  for (const double shift : {0.0007, 0.003, 0.0025, 0.0013, -0.004, -0.0035, 0.0002}) {
    const Eigen::VectorXd position = rest + (shift * axis).replicate(body.NodeCount(), 1);
    const Kinematics at{body, position, still, still, 0, 0, state};
    Eigen::VectorXd force = still;
    support->AddForce(at, &force);
    slip = std::clamp(slip, shift - kDistance, shift + kDistance);
    const Eigen::Vector3d expected = -kModulus * Surface() * (shift - slip) * axis;
    // Rounding of a sum of some hundred areas.
    EXPECT_LT((force.reshaped(3, body.NodeCount()).rowwise().sum() - expected).norm(),
              1e-12 * kModulus * Surface() * kDistance)
        << shift;
    Eigen::VectorXd at_end(state.size());
    support->AdvanceState(at, &at_end);
    state = at_end;
  }
}

// A block on a bed that slides and one that does not: pulled away and released, it stays where both
// are in equilibrium.
TEST(SlippingSupport, LeavesTheBlockDisplaced) {
  constexpr double kOther = 4e5;  // Pa/m
  const Model model{
      std::make_shared<Body>(MakeBody(BoxMesh({0, 0, 0}, kSize, {3, 2, 4}), 1000)),
      {MakeEffect("linear", {{"young_modulus", 1e9}, {"poisson_ratio", 0}}),
       MakeEffect("slipping_support", {{"modulus", kModulus}, {"slip_distance", kDistance}}),
       MakeEffect("elastic_support", {{"modulus", kOther}})},
      {}};
  const int nodes = model.body->NodeCount();
  const Eigen::VectorXd areas = NodeBoundaryAreas(*model.body);
  Stepper stepper(model, {});
  MotionHistory history = RestHistory(model);
  const auto shift = [&](double traction) {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(3 * nodes);
    for (int i = 0; i < nodes; ++i) force[3 * i] = traction * areas[i];
    const StepSummary summary = stepper.Equilibrium(force, &history);
    EXPECT_TRUE(summary.IsUsable()) << summary.message;
    return (history.position.reshaped(3, nodes) - model.body->mesh.nodes).row(0).mean();
  };
  // Tractions of 1 kPa strain the block by 1e-6 of its 30 mm.
  constexpr double kStrained = 1e-7;  // m
  EXPECT_NEAR(shift(0.9 * (kModulus + kOther) * kDistance), 0.9 * kDistance, kStrained);
  EXPECT_NEAR(shift(0), 0, kStrained);
  const double traction = 1.5 * (kModulus + kOther) * kDistance;
  const double drawn = (traction - kModulus * kDistance) / kOther;
  EXPECT_NEAR(shift(traction), drawn, kStrained);
  EXPECT_NEAR(shift(0), kModulus * (drawn - kDistance) / (kModulus + kOther), kStrained);
}

TEST(SlippingSupport, RefusesAnEmptyPart) {
  const auto support = MakeEffect(
      "slipping_support",
      {{"modulus", kModulus}, {"slip_distance", kDistance}, {"point_z", 0.09}, {"normal_z", 1}});
  const Body body = MakeBody(BoxMesh({0, 0, 0}, kSize, {3, 2, 4}), 1000);
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped();
  Eigen::VectorXd state;
  support->InitialState(body, &state);
  Eigen::VectorXd force = 0 * rest;
  EXPECT_THROW(support->AddForce({body, rest, force, force, 0, 0, state}, &force), InputError);
}

}  // namespace
}  // namespace lacuna
