// Properties that all branches with a memory of past strains share.
#include "fem/memory_branch.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <tuple>

#include "effects/catalogue.h"
#include "fem/stepper.h"
#include "support/strained_body.h"

namespace lacuna {
namespace {

constexpr double kModulus = 1e5;  // Pa

struct BranchType {
  std::string type;
  std::map<std::string, double> parameters;  // besides the modulus

  std::shared_ptr<const Effect> Make(double modulus = kModulus) const {
    std::map<std::string, double> all = parameters;
    all["modulus"] = modulus;
    return MakeEffect(type, all);
  }
};

class MemoryBranchOf : public testing::TestWithParam<BranchType> {};

const Eigen::Matrix3d kDeformation{{1.2, 0.1, 0}, {-0.2, 0.9, 0.1}, {0.1, 0, 1.1}};

TEST_P(MemoryBranchOf, NeverReleasesEnergyInAClosedCycle) {
  for (const double strain : {0.1, 1.5}) {              // up to inverted elements
    for (const double duration : {0.003, 0.15, 6.0}) {  // of a relaxation time of 0.03 s
      for (unsigned seed = 1; seed <= 5; ++seed) {
        StrainedBody body(GetParam().Make(), 2);
        EXPECT_GT(body.WorkOfACycle(strain, duration, seed), 0) << strain << ' ' << duration;
      }
    }
  }
}

TEST_P(MemoryBranchOf, RemembersInTheFrameOfTheMaterial) {
  // A body that is rotated between two steps has the rotated stress of a body that is not.
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 1, -0.4).normalized()).toRotationMatrix();
  StrainedBody turned(GetParam().Make()), still(GetParam().Make());
  turned.Deform(kDeformation, 0.01);
  still.Deform(kDeformation, 0.01);
  const Eigen::Matrix3d next = 0.5 * (kDeformation + Eigen::Matrix3d::Identity());
  const Eigen::Matrix3d expected = R * still.Deform(next, 0.01);
  ASSERT_GT(expected.norm(), 0.01 * kModulus);
  // Rounding of strains (1e-16) and of sums.
  EXPECT_LT((turned.Deform(R * next, 0.01) - expected).norm(), 1e-12 * kModulus);
}

// A nearly incompressible branch that is stretched by a fifth at constant volume, with all other
// stress taken up by a pressure that does not belong to it, meets the stress of its modulus.
TEST(MemoryBranch, IsNoStifferWhereTheVolumeIsKept) {
  const double stretch = 1.2, across = 1 / std::sqrt(stretch);
  const Eigen::Matrix3d F = Eigen::Vector3d(stretch, across, across).asDiagonal();
  const auto nominal_stress = [&](const std::string& type, const std::string& parameter,
                                  double value, double poisson_ratio) {
    StrainedBody body(MakeEffect(
        type, {{"modulus", kModulus}, {parameter, value}, {"poisson_ratio", poisson_ratio}}));
    const Eigen::Matrix3d cauchy = body.Deform(F, 1e-6) * F.transpose();
    return (cauchy(0, 0) - cauchy(1, 1)) / stretch;
  };
  for (const auto& [type, parameter, value] :
       {std::tuple("viscoelastic_branch", "relaxation_time", 1e3),
        std::tuple("softening", "softening_strain", 1e3)}) {
    EXPECT_NEAR(nominal_stress(type, parameter, value, 0.499), 0.2 * kModulus, 0.01 * kModulus)
        << type;
    // At constant volume only the shear modulus m/(2 + 2ν) counts.
    EXPECT_NEAR(nominal_stress(type, parameter, value, 0.3) / 1.499,
                nominal_stress(type, parameter, value, 0.499) / 1.3, 2e-4 * kModulus)
        << type;
  }
}

TEST_P(MemoryBranchOf, HasAMemoryIndependentOfItsSize) {
  const auto none = GetParam().Make(0);
  StrainedBody large(GetParam().Make()), absent(none);
  for (const double share : {1.0, 0.3}) {
    const Eigen::Matrix3d F = share * kDeformation + (1 - share) * Eigen::Matrix3d::Identity();
    EXPECT_GT(large.Deform(F, 0.01).norm(), 0);
    EXPECT_EQ(absent.Deform(F, 0.01).norm(), 0);
  }
  EXPECT_GT(large.state().norm(), 0);
  EXPECT_EQ(large.state(), absent.state());
  // A diagnosis uses the derivative of an effect that the model does not contain yet.
  const Eigen::VectorXd position = (kDeformation * absent.body().mesh.nodes).reshaped();
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(position.size());
  Eigen::VectorXd derivative = zero;
  none->AddParameterDerivative({absent.body(), position, zero, zero, 0, 0.01, absent.state()}, 0,
                               &derivative);
  const Eigen::VectorXd force = large.Move(position, 0.01);
  ASSERT_GT(force.norm(), 0);
  EXPECT_LT((kModulus * derivative - force).norm(), 1e-13 * force.norm());
}

TEST_P(MemoryBranchOf, ConvergesWhenTheBodyIsCompressedAndReleased) {
  // Two plates compress the block to 60 % of its length and release it within 0.4 s; the branch is
  // as stiff as the block. (At half its length the neo-Hookean block alone is no longer stable.)
  const auto body =
      std::make_shared<Body>(MakeBody(BoxMesh({0, 0, 0}, {0.04, 0.02, 0.02}, {4, 2, 2}, 2), 1000));
  std::vector<int> ends[2];
  for (int i = 0; i < body->NodeCount(); ++i) {
    if (body->mesh.nodes(0, i) < 1e-9) ends[0].push_back(i);
    if (body->mesh.nodes(0, i) > 0.04 - 1e-9) ends[1].push_back(i);
  }
  const Eigen::VectorXi plate = Eigen::Map<Eigen::VectorXi>(ends[1].data(), ends[1].size());
  const auto motion = [body, plate](double time) {
    Eigen::Matrix3Xd held = body->mesh.nodes(Eigen::all, plate);
    held.row(0).array() -= 0.008 * (1 - std::cos(2 * std::numbers::pi * time / 0.4));
    return held;
  };
  const Model model{
      body,
      {MakeEffect("neo_hookean", {{"young_modulus", kModulus}, {"poisson_ratio", 0.4}}),
       GetParam().Make()},
      {{Eigen::Map<Eigen::VectorXi>(ends[0].data(), ends[0].size()), {}}, {plate, motion}}};
  // A tangent for each iteration.
  Stepper stepper(model, {.linear = {.method = LinearSolverOptions::Method::kDirect}});
  MotionHistory history = RestHistory(model);
  int iterations = 0;
  for (int n = 0; n < 40; ++n) {
    const StepSummary summary = stepper.Step(0.01, {}, &history);
    ASSERT_TRUE(summary.IsUsable()) << n << ": " << summary.message;
    iterations += summary.iterations;
  }
  // Newton's method converges quadratically: two or three iterations per step, including the one
  // that moves the plate.
  EXPECT_LE(iterations, 4 * 40);
}

INSTANTIATE_TEST_SUITE_P(
    All, MemoryBranchOf,
    testing::Values(BranchType{"viscoelastic_branch",
                               {{"relaxation_time", 0.03}, {"poisson_ratio", 0.4}}},
                    BranchType{"elastoplastic_branch", {{"yield_strain", 0.05}}},
                    BranchType{"softening", {{"softening_strain", 0.1}, {"poisson_ratio", 0.4}}}),
    [](const auto& info) { return info.param.type; });

}  // namespace
}  // namespace lacuna
