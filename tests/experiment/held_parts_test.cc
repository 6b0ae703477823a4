#include "experiment/held_parts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

using testing::HasSubstr;

HeldPart Below(const std::string& name, int axis, double at, AxisSet axes, bool moves = false) {
  const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
  return {{name, HalfSpaceRegion{at * unit, -unit}}, axes, moves};
}

class HeldParts : public testing::Test {
 protected:
  std::string ErrorOf(const std::vector<HeldPart>& parts) const {
    try {
      NodesOfParts(parts, mesh_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  const TetMesh mesh_ = BoxMesh({0, 0, 0}, {1, 1, 1}, {2, 2, 2});  // 27 nodes
};

TEST_F(HeldParts, PlanesOfSymmetryShareTheirEdgeAndEndAtAClamp) {
  const std::vector<Eigen::VectorXi> held =
      NodesOfParts({Below("x plane", 0, 0, AxisSet::Of(0)), Below("y plane", 1, 0, AxisSet::Of(1)),
                    Below("clamp", 2, 0, AxisSet::All(), /*moves=*/true)},
                   mesh_);
  EXPECT_EQ(held[0].size(), 6);  // nine, less the three of the clamp
  EXPECT_EQ(held[1].size(), 6);
  EXPECT_EQ(held[2].size(), 9);
}

TEST_F(HeldParts, WhatContradictsIsNamed) {
  EXPECT_THAT(ErrorOf({Below("a", 0, 0, AxisSet::All()), Below("b", 1, 0, AxisSet::All())}),
              HasSubstr("\"a\" and \"b\" hold the same part"));
  EXPECT_THAT(ErrorOf({Below("plane", 0, 0, AxisSet::Of(0)),
                       Below("plate", 1, 0, AxisSet::Of(0), /*moves=*/true)}),
              HasSubstr("\"plane\" and \"plate\" hold the same part"));
  EXPECT_EQ(ErrorOf({Below("plane", 0, 0, AxisSet::Of(0)),
                     Below("plate", 1, 0, AxisSet::Of(1), /*moves=*/true)}),
            "")
      << "along different axes";
  EXPECT_THAT(ErrorOf({Below("clamp", 0, 0, AxisSet::All()), Below("line", 0, 0, AxisSet::Of(1))}),
              HasSubstr("\"line\": other regions hold all its nodes"));
  EXPECT_THAT(
      ErrorOf({Below("all", 0, 1, AxisSet::All())}),
      HasSubstr("\"all\" holds all 27 nodes of the body, so that nothing can move (a half_space"));
  EXPECT_THAT(ErrorOf({Below("x and y", 0, 1, AxisSet::Of(0) | AxisSet::Of(1)),
                       Below("z", 0, 1, AxisSet::Of(2))}),
              HasSubstr("\"z\" and those before it hold all 27 nodes of the body"));
  EXPECT_EQ(ErrorOf({Below("all", 0, 1, AxisSet::Of(0) | AxisSet::Of(1))}), "") << "z is free";
}

}  // namespace
}  // namespace lacuna
