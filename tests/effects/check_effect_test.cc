// What CheckEffect() notices in effects whose energy has been planted.
#include "support/check_effect.h"

#include <gmock/gmock.h>
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "effects/catalogue.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// An effect without memory in which the energy alone is changed.
class WithOtherEnergy final : public Effect {
 public:
  using Change = std::function<std::optional<double>(const std::optional<double>& own)>;

  WithOtherEnergy(std::shared_ptr<const Effect> effect, Change change)
      : effect_(std::move(effect)), change_(std::move(change)) {}

  const EffectCard& Card() const override { return effect_->Card(); }
  Eigen::VectorXd Parameters() const override { return effect_->Parameters(); }
  std::shared_ptr<const Effect> WithParameters(const Eigen::VectorXd& values) const override {
    return std::make_shared<WithOtherEnergy>(effect_->WithParameters(values), change_);
  }
  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    effect_->AddForce(at, force);
  }
  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                   BlockMatrix* tangent) const override {
    effect_->AddTangents(at, weights, convexify, tangent);
  }
  bool AddSkewTangents(const Kinematics& at, const TangentWeights& weights,
                       BlockMatrix* tangent) const override {
    return effect_->AddSkewTangents(at, weights, tangent);
  }
  void AddParameterDerivative(const Kinematics& at, int parameter,
                              Eigen::VectorXd* derivative) const override {
    effect_->AddParameterDerivative(at, parameter, derivative);
  }
  std::optional<double> Energy(const Kinematics& at) const override {
    return change_(effect_->Energy(at));
  }

 private:
  std::shared_ptr<const Effect> effect_;
  Change change_;
};

// The failures of CheckEffect() with this energy in place of the effect's own.
std::vector<std::string> FailuresOf(std::shared_ptr<const Effect> effect,
                                    const CheckEffectOptions& options,
                                    WithOtherEnergy::Change change) {
  const WithOtherEnergy planted(std::move(effect), std::move(change));
  testing::TestPartResultArray results;
  {
    const testing::ScopedFakeTestPartResultReporter reporter(
        testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &results);
    CheckEffect(&planted, options);
  }
  std::vector<std::string> failures;
  for (int k = 0; k < results.size(); ++k)
    failures.emplace_back(results.GetTestPartResult(k).message());
  return failures;
}

std::optional<double> Own(const std::optional<double>& energy) { return energy; }
std::optional<double> Lost(const std::optional<double>&) { return std::nullopt; }

std::shared_ptr<const Effect> Spring() { return MakeEffect("elastic_support", {{"modulus", 1e5}}); }
const CheckEffectOptions kOfSpring{
    .without_influence = {"point_x", "point_y", "point_z", "radius"}};

// A mass whose weight has a potential, which its inertia does not have.
std::shared_ptr<const Effect> Mass() {
  return MakeEffect("attached_mass", {{"mass", 0.02},
                                      {"centre_x", 0.02},
                                      {"centre_y", -0.02},
                                      {"centre_z", 0.03},
                                      {"radius", 0.015},
                                      {"gravity_x", 1},
                                      {"gravity_y", 0},
                                      {"gravity_z", -9.8}});
}
const CheckEffectOptions kOfMass{.depends_on_position = false, .depends_on_acceleration = true};

std::shared_ptr<const Effect> Drag() { return MakeEffect("drag", {{"coefficient", 40}}); }
const CheckEffectOptions kOfDrag{.depends_on_position = false, .depends_on_velocity = true};

TEST(CheckEffect, FindsNothingInSoundEffects) {
  EXPECT_THAT(FailuresOf(Spring(), kOfSpring, Own), IsEmpty());
  EXPECT_THAT(FailuresOf(Mass(), kOfMass, Own), IsEmpty());
  EXPECT_THAT(FailuresOf(Drag(), kOfDrag, Own), IsEmpty());
}

TEST(CheckEffect, NoticesALostEnergy) {
  const auto is_noticed =
      AllOf(Not(IsEmpty()), Each(HasSubstr("the force has a potential, but no energy")));
  EXPECT_THAT(FailuresOf(Spring(), kOfSpring, Lost), is_noticed);
  // The mass has one without inertia only.
  EXPECT_THAT(FailuresOf(Mass(), kOfMass, Lost),
              AllOf(is_noticed, Each(HasSubstr("without inertia"))));
}

TEST(CheckEffect, NoticesAnEnergyThatIsNotThatOfTheForce) {
  const auto is_noticed = AllOf(Not(IsEmpty()), Each(HasSubstr("f = −∂E/∂x")));
  EXPECT_THAT(FailuresOf(Spring(), kOfSpring, [](const auto&) { return 0.0; }), is_noticed);
  EXPECT_THAT(FailuresOf(Spring(), kOfSpring, [](const auto& own) { return 1.001 * *own; }),
              is_noticed);
  EXPECT_THAT(FailuresOf(Spring(), kOfSpring, [](const auto& own) { return -*own; }), is_noticed);
}

TEST(CheckEffect, NoticesAnEnergyOfAForceWithoutAPotential) {
  EXPECT_THAT(FailuresOf(Drag(), kOfDrag, [](const auto&) { return 0.0; }),
              AllOf(Not(IsEmpty()), Each(HasSubstr("the force has no potential, but an energy"))));
}

// A law of the user does not know the potential of its force.
TEST(CheckEffect, AsksForNoEnergyThatIsNotKnown) {
  CheckEffectOptions options = kOfSpring;
  options.has_known_energy = false;
  EXPECT_THAT(FailuresOf(Spring(), options, Lost), IsEmpty());
}

}  // namespace
}  // namespace lacuna
