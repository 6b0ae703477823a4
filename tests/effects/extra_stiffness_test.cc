// Stiffness that differs from place to place: inclusion and stiffness_gradient.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>

#include "effects/catalogue.h"
#include "fem/stepper.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"
#include "support/one_element.h"

namespace lacuna {
namespace {

constexpr double kYoung = 1e5;     // Pa, of the body
constexpr double kLength = 0.08;   // m
constexpr double kWidth = 0.0005;  // m

// The force, N, that stretches a bar from x = 0 to kLength by one hundred thousandth. Poisson's
// ratio is 0, so that stress is uniaxial.
double ForceOfBar(const std::shared_ptr<const Effect>& extra) {
  const TetMesh mesh =
      BoxMesh({0, -kWidth / 2, -kWidth / 2}, {kLength, kWidth / 2, kWidth / 2}, {32, 1, 1}, 2);
  Model model{std::make_shared<const Body>(MakeBody(mesh, 1000)),
              {MakeEffect("linear", {{"young_modulus", kYoung}, {"poisson_ratio", 0}}), extra},
              {}};
  const Eigen::VectorXi near = NodesWhere(mesh, [](const Eigen::Vector3d& x) { return x[0] == 0; });
  const Eigen::VectorXi far =
      NodesWhere(mesh, [](const Eigen::Vector3d& x) { return x[0] > kLength - 1e-9; });
  Eigen::Matrix3Xd places = mesh.nodes(Eigen::all, far);
  places.row(0).array() += 1e-5 * kLength;
  model.grips = {{near, {}}, {far, [places](double) { return places; }}};
  MotionHistory history = RestHistory(model);
  const StepSummary summary =
      Stepper(model, {.relative_tolerance = 1e-11}).Equilibrium({}, &history);
  EXPECT_TRUE(summary.IsUsable()) << summary.message;
  double force = 0;
  for (const auto& effect : model.effects) {
    const Eigen::VectorXd nodal =
        ForceAt(*effect, *model.body, history.position, 0 * history.position);
    for (const int node : near) force += nodal[3 * node];
  }
  return force;
}

// Sections in series: ∫ dx/E, by Simpson's rule of an error far below the mesh's.
double ForceOfSections(const std::function<double(double)>& young) {
  constexpr int kIntervals = 1000;
  double compliance = 0;
  for (int k = 0; k <= kIntervals; ++k) {
    const double weight = k == 0 || k == kIntervals ? 1 : (k % 2 == 1 ? 4 : 2);
    compliance += weight * kLength / kIntervals / 3 / young(kLength * k / kIntervals);
  }
  return 1e-5 * kLength * kWidth * kWidth / compliance;
}

std::shared_ptr<const Effect> Lump(double difference, const Eigen::Vector3d& centre, double radius,
                                   double poisson) {
  return MakeEffect("inclusion", {{"young_modulus_difference", difference},
                                  {"centre_x", centre[0]},
                                  {"centre_y", centre[1]},
                                  {"centre_z", centre[2]},
                                  {"radius", radius},
                                  {"poisson_ratio", poisson}});
}

TEST(Inclusion, IsANeoHookeanSolidWeightedByItsBump) {
  const OneElement element;
  const Eigen::Matrix3d F{{1.2, 0.3, -0.1}, {0.1, 0.8, 0.2}, {-0.2, 0.1, 0.9}};
  const auto solid = MakeEffect("neo_hookean", {{"young_modulus", 3e4}, {"poisson_ratio", 0.4}});
  const Eigen::Matrix3d stress = element.Stress(*solid, F);
  const Eigen::Vector3d point = element.body.mesh.nodes.rowwise().mean();
  for (const double radii : {0.0, 1.0, 2.0}) {
    const Eigen::Vector3d centre = point + radii * 0.01 * Eigen::Vector3d(0, 0.6, -0.8);
    const double weight = std::exp(-radii * radii / 2);
    EXPECT_LT((element.Stress(*Lump(-3e4, centre, 0.01, 0.4), F) + weight * stress).norm(),
              1e-12 * stress.norm());
  }
}

TEST(Inclusion, StiffensABarAsSectionsInSeriesDo) {
  constexpr double kCentre = 0.03, kRadius = 0.012;
  for (const double difference : {3e5, -8e4}) {
    const double expected = ForceOfSections([&](double x) {
      return kYoung + difference * std::exp(-std::pow(x - kCentre, 2) / (2 * kRadius * kRadius));
    });
    // Off the axis the bump is lower by (width/radius)²/12 on average, 1.4e-4, which counts for up
    // to ΔE/(E + ΔE) = 4 times as much.
    EXPECT_NEAR(ForceOfBar(Lump(difference, {kCentre, 0, 0}, kRadius, 0)), expected,
                6e-4 * expected);
  }
}

std::shared_ptr<const Effect> Gradient(double difference) {
  return MakeEffect("stiffness_gradient", {{"young_modulus_difference", difference},
                                           {"axis_x", 2},
                                           {"axis_y", 0},
                                           {"axis_z", 0},
                                           {"length", kLength},
                                           {"poisson_ratio", 0}});
}

TEST(StiffnessGradient, StiffensABarAsSectionsInSeriesDo) {
  for (const double difference : {3e5, -8e4}) {
    const double closed_form =
        1e-5 * kWidth * kWidth * difference / std::log(1 + difference / kYoung);
    const double expected =
        ForceOfSections([&](double x) { return kYoung + difference * x / kLength; });
    // Simpson's rule: (interval/length)⁴.
    EXPECT_NEAR(expected, closed_form, 1e-9 * closed_form);
    // Quadratic elements of 1/32 of the length miss 2e-7; so does Hooke's law at strains of 1e-5.
    EXPECT_NEAR(ForceOfBar(Gradient(difference)), expected, 1e-6 * expected);
  }
}

TEST(ExtraStiffness, IsReadFromYamlWithThePoissonRatioOfTheMaterial) {
  const auto material =
      MakeEffect("corotational", {{"young_modulus", 7e4}, {"poisson_ratio", 0.42}});
  const Config config = Config::Parse(
      "effects:\n"
      "  - {type: inclusion, young_modulus_difference: 20 kPa, centre: [1 cm, 0, -2 cm],\n"
      "     radius: 5 mm}\n"
      "  - {type: stiffness_gradient, young_modulus_difference: -20 kPa, axis: [0, 0, 1],\n"
      "     length: 12 cm, poisson_ratio: 0.3}\n",
      "a.yaml");
  const std::vector<Config> items = config.Items("effects");
  Eigen::VectorXd lump(6), gradient(9);
  lump << 2e4, 0.01, 0, -0.02, 0.005, 0.42;
  gradient << -2e4, 0, 0, 0, 0, 0, 1, 0.12, 0.3;
  EXPECT_LT((MakeEffect(items[0], material.get())->Parameters() - lump).norm(), 1e-10);
  EXPECT_LT((MakeEffect(items[1], material.get())->Parameters() - gradient).norm(), 1e-10);
  config.RefuseUnknownKeys();
  EXPECT_THROW(MakeEffect(items[0]), InputError) << "no Poisson's ratio";
}

TEST(ExtraStiffness, RefusesAGradientWithoutDirection) {
  EXPECT_THROW(MakeEffect(Config::Parse("type: stiffness_gradient\naxis: [0, 0, 0]\n"
                                        "young_modulus_difference: 1 kPa\npoisson_ratio: 0.3\n",
                                        "a.yaml")),
               InputError);
}

}  // namespace
}  // namespace lacuna
