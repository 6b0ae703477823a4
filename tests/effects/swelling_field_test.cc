#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <string>

#include "effects/catalogue.h"
#include "effects/effect_text.h"
#include "fem/nodal_recovery.h"
#include "fem/stepper.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"
#include "support/one_element.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

std::shared_ptr<const Effect> FieldSwelling(const std::string& strain, const std::string& field) {
  return MakeEffect(Config::Parse(
      "type: swelling_field\nstrain: " + strain + "\nfield: \"" + field + "\"\n", "a.yaml"));
}

constexpr double kFieldModulus = 8e4;  // Pa
constexpr double kFieldRatio = 0.4;    // Poisson's

std::shared_ptr<const Effect> LawOfField(const std::string& type) {
  return MakeEffect(type, {{"young_modulus", kFieldModulus}, {"poisson_ratio", kFieldRatio}});
}

// The fields are between −1 and 4 on the block of CheckEffect, which is 60 mm long.
TEST(SwellingField, PassesTheEffectChecks) {
  for (const char* type : {"corotational", "st_venant_kirchhoff", "neo_hookean"}) {
    const auto law = LawOfField(type);
    for (const char* field : {"1 + 30*X - 20*Y*Z/0.01", "3*exp(-Z/0.03)"})
      CheckEffect(FieldSwelling("4 %", field).get(), {.elasticity = law.get()});
  }
}

TEST(SwellingField, IsUniformSwellingForAConstantField) {
  OneElement element;
  const Eigen::Matrix3d F{{1.1, 0.05, 0}, {-0.02, 1.03, 0.1}, {0.01, 0, 0.95}};
  for (const char* type : {"linear", "corotational", "st_venant_kirchhoff", "neo_hookean"}) {
    const auto law = LawOfField(type);
    element.elasticity = law.get();
    const auto field = FieldSwelling("4 %", "2");
    const auto uniform = MakeEffect("swelling", {{"strain", 0.08}});
    const Eigen::VectorXd expected = element.Force(*uniform, F);
    // Both compute the same from other factors: rounding.
    EXPECT_LT((element.Force(*field, F) - expected).norm(), 1e-11 * expected.norm()) << type;
    EXPECT_NEAR(element.Energy(*field, F), element.Energy(*uniform, F),
                1e-11 * element.Energy(*law, F));
    EXPECT_EQ(element.Force(*field->WithParameters(Eigen::VectorXd::Zero(1)), F).norm(), 0);
  }
}

// A strain that is linear in the place is compatible: a free body bends into an arc without stress.
// Boley & Weiner, Theory of Thermal Stresses, 1960, section 4.1: with ε = c Z the displacement is
// u = c (X Z, Y Z, (Z² − X² − Y²)/2).
TEST(SwellingField, BendsAFreeBodyWithoutStress) {
  constexpr double kCurvature = 0.01;  // 1/m; strains are below 1e-3
  const TetMesh mesh = BoxMesh({0, 0, 0}, {0.04, 0.02, 0.02}, {4, 2, 2}, 2);
  const auto law = LawOfField("linear");
  Model model{
      std::make_shared<const Body>(MakeBody(mesh, 1000)), {law, FieldSwelling("0.01", "Z")}, {}};
  Eigen::Matrix3Xd expected = mesh.nodes;
  for (Eigen::Index i = 0; i < mesh.NodeCount(); ++i) {
    const Eigen::Vector3d X = mesh.nodes.col(i);
    expected.col(i) +=
        kCurvature * Eigen::Vector3d(X.x() * X.z(), X.y() * X.z(),
                                     0.5 * (X.z() * X.z() - X.x() * X.x() - X.y() * X.y()));
  }
  const Eigen::VectorXi held = NodesWhere(mesh, [](const Eigen::Vector3d& x) { return x[0] == 0; });
  const Eigen::Matrix3Xd places = expected(Eigen::all, held);
  model.grips.push_back({held, [places](double) { return places; }});
  MotionHistory history = RestHistory(model);
  const StepSummary summary =
      Stepper(model, {.relative_tolerance = 1e-11}).Equilibrium({}, &history);
  ASSERT_TRUE(summary.IsUsable()) << summary.message;
  // The solution is quadratic. The multiplicative split differs from the sum of the strains by
  // products of strains, 2e-4 of them.
  EXPECT_LT((history.position - expected.reshaped()).norm(), 1e-3 * (expected - mesh.nodes).norm());
  const NodalStress stress =
      RecoverNodalStress(model, history.position, history.velocity, 0, history.effect_state);
  EXPECT_LT(stress.cauchy.cwiseAbs().maxCoeff(), 1e-3 * kFieldModulus * kCurvature * 0.02);
}

TEST(SwellingField, IsWrittenAndReadBack) {
  const auto swelling = FieldSwelling("-0.3 %", "min(X, Z)/0.02");
  const auto text = FormatEffect(*swelling);
  ASSERT_TRUE(text.has_value());
  const auto again = MakeEffect(Config::Parse(*text, "a.yaml"));
  EXPECT_EQ(again->Parameters(), swelling->Parameters());
  EXPECT_EQ(FormatEffect(*again), text);
}

TEST(SwellingField, ReportsAFieldThatCannotBeRead) {
  try {
    FieldSwelling("1 %", "1 + temperature");
    FAIL() << "the name was accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("a.yaml:3:"));
    EXPECT_THAT(error.what(), HasSubstr("temperature"));
  }
}

// Nothing shrinks to less than nothing: the force is not a number, so that a step fails.
TEST(SwellingField, HasNoForceBeyondCompleteShrinkage) {
  OneElement element;
  const auto law = LawOfField("neo_hookean");
  element.elasticity = law.get();
  EXPECT_FALSE(element.Force(*FieldSwelling("-1", "2"), Eigen::Matrix3d::Identity()).allFinite());
}

}  // namespace
}  // namespace lacuna
