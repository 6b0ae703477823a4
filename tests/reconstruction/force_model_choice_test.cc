#include "reconstruction/force_model_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "core/error.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

// The number of coefficients that are left of forces on these nodes of a bar.
Eigen::Index CoefficientsOn(const std::vector<int>& nodes, ForceSettings::Kind kind) {
  ReconstructionStudy study;
  study.name = "bar";
  study.follow.forces.kind = kind;
  study.follow.forces.hold_net_force = true;
  study.follow.forces.region = Region{"pushed", NodeRegion{nodes}};
  Model model;
  model.body = std::make_shared<const Body>(
      MakeBody(BoxMesh({0, 0, 0}, {0.08, 0.02, 0.02}, {4, 1, 1}), 1000));
  return MakeForceModel(study, model).CoefficientCount();
}

TEST(ForceModelChoice, ForcesWithoutANetForceAreRefusedWhereThereAreNone) {
  using Kind = ForceSettings::Kind;
  const auto refused = testing::ThrowsMessage<InputError>(
      testing::HasSubstr("bar: forces.hold_net_force: the forces on the "));
  EXPECT_THAT([] { CoefficientsOn({0}, Kind::kNodal); }, refused);
  EXPECT_THAT(([] { CoefficientsOn({0, 1, 5}, Kind::kFootprint); }), refused);
  // Two nodes can be pushed apart.
  EXPECT_EQ(CoefficientsOn({0, 1}, Kind::kNodal), 1);
}

}  // namespace
}  // namespace lacuna
