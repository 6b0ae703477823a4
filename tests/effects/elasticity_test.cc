#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>

#include "effects/catalogue.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"
#include "support/one_element.h"

namespace lacuna {
namespace {

constexpr double kYoung = 1.2e5;  // Pa
constexpr double kPoisson = 0.37;

std::shared_ptr<const Effect> Law(const std::string& type, double young = kYoung,
                                  double poisson = kPoisson) {
  return MakeEffect(type, {{"young_modulus", young}, {"poisson_ratio", poisson}});
}

class ElasticityLaw : public testing::TestWithParam<std::string> {};

TEST_P(ElasticityLaw, PassesTheEffectChecks) { CheckEffect(Law(GetParam()).get()); }

TEST_P(ElasticityLaw, PassesTheEffectChecksForCrushedAndInvertedElements) {
  // Finite differences near the kinks of strongly distorted elements need small steps, which causes
  // more rounding.
  CheckEffect(Law(GetParam()).get(), {.strain = 4, .tolerance = 1e-5});
}

TEST_P(ElasticityLaw, IsHookesLawAtSmallStrain) {
  const OneElement element;
  const auto law = Law(GetParam());
  Eigen::Matrix3d strain{{1.0, 0.4, -0.3}, {0.4, -0.7, 0.2}, {-0.3, 0.2, 0.5}};
  strain *= 1e-7;
  const double mu = kYoung / (2 * (1 + kPoisson));
  const double lambda = kYoung * kPoisson / ((1 + kPoisson) * (1 - 2 * kPoisson));
  const Eigen::Matrix3d hooke =
      2 * mu * strain + lambda * strain.trace() * Eigen::Matrix3d::Identity();
  // The next order in the strain is smaller by 1e-7.
  EXPECT_LT((element.Stress(*law, Eigen::Matrix3d::Identity() + strain) - hooke).norm(),
            1e-6 * hooke.norm());
}

TEST_P(ElasticityLaw, HasNoStressAtRest) {
  const OneElement element;
  EXPECT_LT(element.Stress(*Law(GetParam()), Eigen::Matrix3d::Identity()).norm(), 1e-14 * kYoung);
  // The strain has a rounding error of 1e-16, and the volume is 3e-6 m³.
  EXPECT_NEAR(element.Energy(*Law(GetParam()), Eigen::Matrix3d::Identity()), 0, 1e-30);
}

INSTANTIATE_TEST_SUITE_P(All, ElasticityLaw,
                         testing::Values("linear", "corotational", "st_venant_kirchhoff",
                                         "neo_hookean"),
                         [](const auto& info) { return info.param; });

TEST(ElasticityLaws, GiveAStressCalculatedByHand) {
  // F = diag(1.5, 1, 1) with λ = μ = 1e5 Pa (ν = ¼, E = 2.5e5 Pa):
  const OneElement element;
  const Eigen::Matrix3d F = Eigen::Vector3d(1.5, 1, 1).asDiagonal();
  const auto diagonal = [&](const std::string& type) {
    return Eigen::Vector3d(element.Stress(*Law(type, 2.5e5, 0.25), F).diagonal() / 1e5);
  };
  const double tolerance = 1e-12;
  // 2μ·0.5 + λ·0.5, λ·0.5
  EXPECT_TRUE(diagonal("linear").isApprox(Eigen::Vector3d(1.5, 0.5, 0.5), tolerance));
  EXPECT_TRUE(diagonal("corotational").isApprox(Eigen::Vector3d(1.5, 0.5, 0.5), tolerance));
  // E₁₁ = 0.625: S = 2·0.625 + 0.625 and 0.625; P = F S
  EXPECT_TRUE(diagonal("st_venant_kirchhoff")
                  .isApprox(Eigen::Vector3d(1.5 * 1.875, 0.625, 0.625), tolerance));
  // J = 1.5: slope 2·0.5 − 1 = 0, so P = μ F: the lateral stress is μ
  EXPECT_TRUE(diagonal("neo_hookean").isApprox(Eigen::Vector3d(1.5, 1, 1), tolerance));
}

TEST(NeoHookean, IsTheTextbookLawOfRubberIfIncompressible) {
  // Uniaxial nominal stress μ (s − 1/s²), the lateral stretch found from zero lateral stress. At
  // ν = 0.4999 the compressibility contributes about (1 − 2ν) of the stress.
  const double young = 3e5, poisson = 0.4999;
  const double mu = young / (2 * (1 + poisson));
  const auto law = Law("neo_hookean", young, poisson);
  const OneElement element;
  for (const double stretch : {0.5, 0.8, 1.3, 2.0, 3.0}) {
    double low = 0.1, high = 3;
    Eigen::Matrix3d stress;
    for (int k = 0; k < 100; ++k) {
      const double lateral = 0.5 * (low + high);
      stress = element.Stress(*law, Eigen::Vector3d(stretch, lateral, lateral).asDiagonal());
      (stress(1, 1) > 0 ? high : low) = lateral;
    }
    EXPECT_NEAR(stress(0, 0), mu * (stretch - 1 / (stretch * stretch)), 1e-3 * young) << stretch;
  }
}

TEST(NeoHookean, PushesInvertedElementsBack) {
  // The element is inverted along x; the force on its far node must restore it.
  const OneElement element;
  const auto law = Law("neo_hookean");
  for (const double s : {-0.2, -1.0, -3.0}) {
    const Eigen::Matrix3d F = Eigen::Vector3d(s, 1, 1).asDiagonal();
    const Eigen::Matrix3d stress = element.Stress(*law, F);
    EXPECT_TRUE(stress.allFinite());
    EXPECT_LT(stress(0, 0), 0) << "energy falls towards the rest shape, at stretch " << s;
  }
}

TEST(Corotational, IsLinearElasticityInARotatedFrame) {
  const OneElement element;
  const Eigen::Matrix3d stretch{{1.1, 0.05, 0.02}, {0.05, 0.95, -0.03}, {0.02, -0.03, 1.04}};
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(2.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const Eigen::Matrix3d linear = element.Stress(*Law("linear"), stretch);
  EXPECT_LT((element.Stress(*Law("corotational"), R * stretch) - R * linear).norm(),
            1e-12 * linear.norm());
}

}  // namespace
}  // namespace lacuna
