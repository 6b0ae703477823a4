#include "fem/natural_modes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "effects/catalogue.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

// The closed form of a bar that is free to contract: f = (2k + 1) c/(4 L), c² = E/ρ for ν = 0.
TEST(NaturalModes, AreThoseOfABar) {
  Model model;
  model.body = std::make_shared<const Body>(
      MakeBody(BoxMesh({0, 0, 0}, {1, 0.02, 0.02}, {20, 1, 1}, 2), 1000));
  model.effects = {MakeEffect("linear", {{"young_modulus", 1e5}, {"poisson_ratio", 0}})};
  std::vector<int> all(static_cast<size_t>(model.body->NodeCount()));
  for (size_t k = 0; k < all.size(); ++k) all[k] = static_cast<int>(k);
  // All nodes move along x only.
  model.grips = {
      {Eigen::Map<Eigen::VectorXi>(all.data(), model.body->NodeCount()),
       {},
       AxisSet::Of(1) | AxisSet::Of(2)},
      {NodesWhere(model.body->mesh, [](const Eigen::Vector3d& x) { return x.x() < 1e-9; }),
       {},
       AxisSet::Of(0)}};
  const NaturalModes modes = FindNaturalModes(model, model.body->mesh.nodes.reshaped(), 2);
  ASSERT_TRUE(modes.IsUsable()) << modes.message;
  const double fundamental = std::sqrt(1e5 / 1000) / 4;
  EXPECT_NEAR(modes.frequencies[0], fundamental, 1e-3 * fundamental);
  EXPECT_NEAR(modes.frequencies[1], 3 * fundamental, 5e-3 * fundamental);
  // A body without supports moves as a rigid body in six ways.
  model.grips.clear();
  model.effects = {MakeEffect("linear", {{"young_modulus", 1e5}, {"poisson_ratio", 0.3}})};
  const NaturalModes free = FindNaturalModes(model, model.body->mesh.nodes.reshaped(), 7);
  ASSERT_TRUE(free.IsUsable()) << free.message;
  EXPECT_LT(free.frequencies[5], 1e-3 * free.frequencies[6]);
}

}  // namespace
}  // namespace lacuna
