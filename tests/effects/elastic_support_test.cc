#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "effects/catalogue.h"
#include "fem/stepper.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"

namespace lacuna {
namespace {

const Eigen::Vector3d kSize(0.03, 0.02, 0.04);  // m
constexpr double kLowerFace = 600e-6;           // m²

Body Block(int order = 1) { return MakeBody(BoxMesh({0, 0, 0}, kSize, {3, 2, 4}, order), 1000); }

TEST(ElasticSupport, PassesTheEffectChecks) {
  // A part that does not fade has no place.
  CheckEffect(MakeEffect("elastic_support", {{"modulus", 1e5}}).get(),
              {.without_influence = {"point_x", "point_y", "point_z", "radius"}});
}

TEST(ElasticSupport, PassesTheEffectChecksOnOneSide) {
  CheckEffect(MakeEffect("elastic_support", {{"modulus", 1e5},
                                             {"point_x", 0.02},
                                             {"point_y", -0.01},
                                             {"point_z", 0.03},
                                             {"side_x", 0.3},
                                             {"side_z", -1},
                                             {"radius", 0.015}})
                  .get());
}

TEST(ElasticSupport, PassesTheEffectChecksForAFadingPart) {
  CheckEffect(MakeEffect("elastic_support", {{"modulus", 1e5},
                                             {"point_x", 0.02},
                                             {"point_z", 0.03},
                                             {"normal_x", -1},
                                             {"normal_z", 0.4},
                                             {"radius", 0.02}})
                  .get());
}

// Displaces a block as a whole and expects that a bed of 0.1 MPa/m holds the nodes of the lower
// face alone, and pulls them back as a bed under this area, m², does.
void ExpectPullOnLowerFace(const Effect& support, int order, double area) {
  const Body body = Block(order);
  const Eigen::Vector3d shift(0.001, 0, -0.002);
  const Eigen::VectorXd position =
      body.mesh.nodes.reshaped() + shift.replicate(body.NodeCount(), 1);
  const Eigen::Matrix3Xd force =
      ForceAt(support, body, position, 0 * position).reshaped(3, body.NodeCount());
  EXPECT_LT((force.rowwise().sum() + 1e5 * area * shift).norm(), 1e-13);
  for (int i = 0; i < body.NodeCount(); ++i) {
    if (body.mesh.nodes(2, i) > 1e-3) {
      EXPECT_EQ(force.col(i).norm(), 0);
    }
  }
}

TEST(ElasticSupport, PullsBackInProportionToArea) {
  // The area of the lower face and half of the lowest row of triangles of the sides, which is 10 mm
  // high for linear and 5 mm for quadratic elements.
  const auto support = MakeEffect("elastic_support", {{"modulus", 1e5}, {"normal_z", -1}});
  for (const int order : {1, 2})
    ExpectPullOnLowerFace(*support, order, kLowerFace + 0.5 * 0.1 * (0.01 / order));
}

TEST(ElasticSupport, LiesAgainstOneSideOnly) {
  // The forces on the lower face alone: the sides, at right angles to it, take no part, whatever
  // the size of their triangles.
  const auto support = MakeEffect("elastic_support", {{"modulus", 1e5}, {"side_z", -2}});
  for (const int order : {1, 2}) ExpectPullOnLowerFace(*support, order, kLowerFace);
}

// A face that is turned by 20° belongs to the side, one that is turned by 70° to the next one;
// where a face is turned by 45°, two sides at right angles share it.
TEST(ElasticSupport, LiesAgainstTheSideThatFacesIt) {
  const Body body = Block();
  const Eigen::VectorXd position = body.mesh.nodes.reshaped().array() + 0.001;
  const auto total = [&](double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    const auto support =
        MakeEffect("elastic_support",
                   {{"modulus", 1e5}, {"side_x", std::sin(angle)}, {"side_z", std::cos(angle)}});
    return -ForceAt(*support, body, position, 0 * position).sum() / (3 * 1e5 * 0.001);  // m²
  };
  constexpr double kUpperFace = kLowerFace, kEnd = 800e-6;  // m²
  EXPECT_NEAR(total(20), kUpperFace, 1e-12);
  EXPECT_NEAR(total(70), kEnd, 1e-12);
  EXPECT_NEAR(total(45), 0.5 * (kUpperFace + kEnd), 1e-12);
}

TEST(ElasticSupport, FadesWithDistance) {
  const auto support =
      MakeEffect("elastic_support", {{"modulus", 1e5}, {"point_x", 0.03}, {"radius", 0.01}});
  const auto whole = MakeEffect("elastic_support", {{"modulus", 1e5}});
  const Body body = Block();
  const Eigen::VectorXd position = body.mesh.nodes.reshaped().array() + 0.001;
  const Eigen::VectorXd faded = ForceAt(*support, body, position, 0 * position);
  const Eigen::VectorXd full = ForceAt(*whole, body, position, 0 * position);
  for (int i = 0; i < body.NodeCount(); ++i) {
    const double distance = (body.mesh.nodes.col(i) - Eigen::Vector3d(0.03, 0, 0)).norm();
    EXPECT_NEAR(faded[3 * i], std::exp(-0.5 * std::pow(distance / 0.01, 2)) * full[3 * i],
                1e-12 * std::abs(full[3 * i]));
  }
}

// A block that only a bed supports sinks until k A u = m g.
TEST(ElasticSupport, CarriesTheWeight) {
  constexpr double kModulus = 1e6, kGravity = 9.81;
  const Model model{std::make_shared<Body>(Block()),
                    {MakeEffect("linear", {{"young_modulus", 1e9}, {"poisson_ratio", 0}}),
                     MakeEffect("gravity", {{"acceleration_z", -kGravity}}),
                     MakeEffect("elastic_support", {{"modulus", kModulus}})},
                    {}};
  MotionHistory history = RestHistory(model);
  const StepSummary summary = Stepper(model, {}).Equilibrium({}, &history);
  ASSERT_TRUE(summary.IsUsable()) << summary.message;
  const double surface =
      2 * (kSize.x() * kSize.y() + kSize.y() * kSize.z() + kSize.z() * kSize.x());
  const double sunk = 1000 * kSize.prod() * kGravity / (kModulus * surface);
  const Eigen::Matrix3Xd shift =
      history.position.reshaped(3, model.body->NodeCount()) - model.body->mesh.nodes;
  // The strain of the block moves its nodes by up to ρ g h²/(2E) = 8e-9 m, compared with 4.5e-5 m.
  EXPECT_LT((shift.colwise() + Eigen::Vector3d(0, 0, sunk)).colwise().norm().maxCoeff(),
            5e-4 * sunk);
}

TEST(ElasticSupport, IsReadFromYamlAndRefusesAnEmptyPart) {
  const Config config = Config::Parse(
      "effects:\n"
      "  - {type: elastic_support, modulus: 2 MPa/m, point: [0, 0, 9 cm], normal: [0, 0, 1],\n"
      "     radius: 1 cm, side: [1, 0, 0]}\n"
      "  - {type: elastic_support, modulus: -2 MPa/m}\n",
      "a.yaml");
  const std::vector<Config> items = config.Items("effects");
  Eigen::VectorXd expected(11);
  expected << 2e6, 0, 0, 0.09, 0, 0, 1, 0.01, 1, 0, 0;
  const auto support = MakeEffect(items[0]);
  EXPECT_LT((support->Parameters() - expected).norm(), 1e-9);
  EXPECT_THROW(MakeEffect(items[1]), InputError);

  const Body body = Block();
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped();
  EXPECT_THROW(ForceAt(*support, body, rest, 0 * rest), InputError);
}

}  // namespace
}  // namespace lacuna
