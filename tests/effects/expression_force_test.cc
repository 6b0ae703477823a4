#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "effects/catalogue.h"
#include "fem/stepper.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"

namespace lacuna {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

constexpr char kMagnet[] = R"yaml(type: expression
name: magnet
per: mass
force: ["0", "0", "-k * exp(-(z - z0)/d)"]
parameters:
  z0: {value: 20 mm, setting: true}
  k: {value: 3 N/kg, plausible: [-10 N/kg, 10 N/kg], meaning: pull at the face}
  d: {value: 50 mm, plausible: [1 mm, 20 cm], min: 0.1 mm, log_scale: true}
)yaml";

std::shared_ptr<const Effect> FromYaml(const std::string& text) {
  const Config config = Config::Parse(text, "a.yaml");
  auto effect = MakeEffect(config);
  config.RefuseUnknownKeys();
  return effect;
}

// With an amplitude k.
std::shared_ptr<const Effect> MakeLaw(const std::string& per, const std::string& force,
                                      const std::string& k, const std::string& more = "") {
  return FromYaml("type: expression\nname: law\nper: " + per + "\nforce: " + force +
                  "\nparameters:\n  k: {value: " + k + ", plausible: [-10 " +
                  k.substr(k.find(' ') + 1) + ", 10 " + k.substr(k.find(' ') + 1) + "]}\n" + more);
}

Eigen::Vector3d Total(const Eigen::VectorXd& force) {
  return force.reshaped(3, force.size() / 3).rowwise().sum();
}

TEST(ExpressionForce, PassesTheEffectChecks) {
  CheckEffect(FromYaml(kMagnet).get());
  CheckEffect(MakeLaw("area", "[-k*abs(vx)*vx, -k*vy + k*nx, '-k*vz*c*(1 + nz^2)']", "3 Pa s/m",
                      "  c: {value: 0.4, plausible: [0, 1]}\n")
                  .get(),
              {.depends_on_position = false, .depends_on_velocity = true});
  // Neither symmetric nor definite, and of everything.
  CheckEffect(MakeLaw("volume",
                      "['k*(y*vz - X*ux) + k*sin(w*t)', 'k*tanh(uy/l)*max(x, -y)', "
                      "'k*atan2(vx, 1 + z*vy)*smooth_step(z/l - 0.2)']",
                      "3 N/m^3",
                      "  l: {value: 0.1 m, plausible: [0.01 m, 1 m]}\n"
                      "  w: {value: 4 1/s, plausible: [0 1/s, 10 1/s]}\n")
                  .get(),
              {.depends_on_velocity = true});
  CheckEffect(MakeLaw("mass", "[k*X, k*cos(3*t), 0]", "3 1/s^2").get(),
              {.depends_on_position = false, .has_known_energy = false});
}

TEST(ExpressionForce, HasACardOfItsOwn) {
  const auto magnet = FromYaml(kMagnet);
  const EffectCard& card = magnet->Card();
  EXPECT_EQ(card.type, "expression");
  EXPECT_THAT(card.title, HasSubstr("magnet"));
  EXPECT_THAT(card.equation, HasSubstr("m_i (0, 0, -k * exp(-(z - z0)/d))"));
  ASSERT_EQ(card.parameters.size(), 3u);
  // The amplitude first: the first that is no setting.
  const ParameterCard& k = card.parameters[0];
  EXPECT_EQ(k.name, "k");
  EXPECT_EQ(k.meaning, "pull at the face");
  EXPECT_STREQ(k.dimension.unit, "m/s^2");
  EXPECT_EQ(k.null_value, 0);
  EXPECT_EQ(k.plausible_min, -10);
  EXPECT_EQ(k.plausible_max, 10);
  EXPECT_FALSE(k.setting);
  EXPECT_EQ(card.parameters[1].name, "z0");
  EXPECT_TRUE(card.parameters[1].setting);
  EXPECT_EQ(card.parameters[2].name, "d");
  EXPECT_TRUE(card.parameters[2].log_scale);
  EXPECT_TRUE(std::isnan(card.parameters[2].null_value));
  EXPECT_DOUBLE_EQ(card.parameters[2].bounds.min, 1e-4);
  EXPECT_TRUE(magnet->Parameters().isApprox(Eigen::Vector3d(3, 0.02, 0.05)));
  // Another amplitude when asked for, with another null value.
  const auto scaled = FromYaml(R"(
type: expression
name: spring
per: volume
force: [-k * (s - 1) * ux, 0, 0]
amplitude: s
parameters:
  k: {value: 2 N/m^4, plausible: [0, 9 N/m^4]}
  s: {value: 3, plausible: [1, 5], null_value: 1}
)");
  EXPECT_EQ(scaled->Card().parameters[0].name, "s");
  EXPECT_EQ(scaled->Card().parameters[0].null_value, 1);
  EXPECT_EQ(scaled->Parameters(), Eigen::Vector2d(3, 2));
}

TEST(ExpressionForce, IsKnownToTheCatalogue) {
  const CatalogueEntry* entry = FindEntry("expression");
  ASSERT_NE(entry, nullptr);
  EXPECT_THAT(entry->card->equation, HasSubstr("docs/expression.md"));
  EXPECT_TRUE(entry->card->repeatable);
}

TEST(ExpressionForce, LeavesItsValuesInTheResolvedFile) {
  const Config config = Config::Parse(kMagnet, "a.yaml");
  MakeEffect(config);
  const nlohmann::json resolved = config.Resolved();
  EXPECT_EQ(resolved["amplitude"], "k");
  EXPECT_EQ(resolved["per"], "mass");
  EXPECT_EQ(resolved["force"][2], "-k * exp(-(z - z0)/d)");
  EXPECT_DOUBLE_EQ(resolved["parameters"]["d"]["value"], 0.05);
  EXPECT_DOUBLE_EQ(resolved["parameters"]["d"]["plausible"][1], 0.2);
}

TEST(ExpressionForce, CountsPerMassVolumeOrArea) {
  const Eigen::Vector3d size(0.03, 0.02, 0.04);
  for (const int order : {1, 2}) {
    const Body body = MakeBody(BoxMesh({0, 0, 0}, size, {3, 2, 4}, order), 1100);
    const Eigen::VectorXd rest = body.mesh.nodes.reshaped();
    const auto total = [&](const std::string& per, const std::string& k) {
      return Total(ForceAt(*MakeLaw(per, "[0, k, 0]", k), body, rest, 0 * rest)).y();
    };
    const double volume = size.prod();
    EXPECT_NEAR(total("mass", "3 N/kg"), 3 * 1100 * volume, 1e-13);
    EXPECT_NEAR(total("volume", "3 N/m^3"), 3 * volume, 1e-16);
    EXPECT_NEAR(total("area", "3 Pa"), 3 * 2 * (0.0006 + 0.0012 + 0.0008), 1e-14);
  }
}

TEST(ExpressionForce, HasTheNormalsOfTheBoundaryAtRest) {
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.03, 0.03, 0.03}, {3, 3, 3}), 1000);
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped();
  const auto law = MakeLaw("volume", "[k*nx, k*ny, k*nz]", "3 N/m^3");
  // Turned over: the normals stay.
  const Eigen::VectorXd force = ForceAt(*law, body, -rest, 0 * rest);
  int faces = 0, inside = 0;
  for (int i = 0; i < body.NodeCount(); ++i) {
    const Eigen::Array3d x = rest.segment<3>(3 * i);
    const Eigen::Array3d outward = (x > 0.0299).cast<double>() - (x < 0.0001).cast<double>();
    const int sides = static_cast<int>(outward.abs().sum());
    if (sides > 1) continue;  // on an edge
    const Eigen::Vector3d expected = 3 * body.node_mass[i] / 1000 * outward;
    EXPECT_LT((force.segment<3>(3 * i) - expected).norm(), 1e-20);
    ++(sides == 1 ? faces : inside);
  }
  EXPECT_EQ(faces, 24);
  EXPECT_EQ(inside, 8);
}

TEST(ExpressionForce, VanishesAtItsNullValueButNotItsDerivative) {
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.03, 0.02, 0.02}, {3, 2, 2}), 1000);
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped();
  const Eigen::VectorXd velocity = 0 * rest, state;
  const auto full = FromYaml(kMagnet);
  const Eigen::VectorXd per_unit = ForceAt(*full, body, rest, velocity) / 3;
  const auto magnet = full->WithParameters(Eigen::Vector3d(0, 0.02, 0.05));
  EXPECT_EQ(ForceAt(*magnet, body, rest, velocity).norm(), 0);
  Eigen::VectorXd derivative = Eigen::VectorXd::Zero(rest.size());
  magnet->AddParameterDerivative({body, rest, velocity, velocity, 0, 0, state}, 0, &derivative);
  ASSERT_GT(per_unit.norm(), 0);
  EXPECT_LT((derivative - per_unit).norm(), 1e-14 * per_unit.norm());
}

TEST(ExpressionForce, StretchesABarLikeAMagnet) {
  // A bar hangs from its top and a magnet below pulls at each kilogram with k exp(−Z/d). With ν = 0
  // it is one-dimensional: E u″ = ρ k exp(−Z/d), u′(0) = 0, u(L) = 0, hence
  // u(0) = −(ρ k d/E) (L − d (1 − exp(−L/d))).
  constexpr double kLength = 0.1, kDecay = 0.03, kPull = 40, kYoung = 1e5, kDensity = 1000;
  const auto body = std::make_shared<Body>(
      MakeBody(BoxMesh({0, 0, 0}, {0.005, 0.005, kLength}, {1, 1, 40}), kDensity));
  const auto magnet = MakeLaw("mass", "[0, 0, -k*exp(-Z/d)]", "40 N/kg",
                              "  d: {value: 30 mm, plausible: [1 mm, 1 m]}\n");
  const Model model{
      body,
      {MakeEffect("linear", {{"young_modulus", kYoung}, {"poisson_ratio", 0}}), magnet},
      {{NodesWhere(body->mesh, [](const Eigen::Vector3d& x) { return x.z() > kLength - 1e-6; }),
        {}}}};
  MotionHistory history = RestHistory(model);
  Stepper stepper(model, {});
  ASSERT_TRUE(stepper.Equilibrium({}, &history).IsUsable());
  const Eigen::VectorXi end =
      NodesWhere(body->mesh, [](const Eigen::Vector3d& x) { return x.z() < 1e-6; });
  const double sunk = history.position.reshaped(3, body->NodeCount()).row(2)(end).mean();
  const double expected =
      -kDensity * kPull * kDecay / kYoung * (kLength - kDecay * (1 - std::exp(-kLength / kDecay)));
  // Linear elements and lumped loads: (element/decay)²/12 = 6e-4.
  EXPECT_NEAR(sunk, expected, 2e-3 * std::abs(expected));
  EXPECT_LT(expected, -5e-4);
}

TEST(ExpressionForce, SwingsAnElasticBodyAsATrapSwingsAPoint) {
  // In a field that is linear in place and velocity inner forces do not move the centre of mass:
  // it is a damped oscillator, whatever the body does.
  constexpr double kRate = 10, kDamping = 1, kStep = 2e-3, kStart = 0.03;
  const auto body = std::make_shared<Body>(
      MakeBody(BoxMesh({-0.02, -0.01, -0.01}, {0.02, 0.01, 0.01}, {2, 1, 1}), 1000));
  const auto trap = MakeLaw("mass", "[-k*(x + 0.03) - 2*c*k/100*vx, 0, 0]", "100 1/s^2",
                            "  c: {value: 1 1/s, plausible: [0 1/s, 5 1/s]}\n");
  const Model model{
      body,
      {MakeEffect("neo_hookean", {{"young_modulus", 1e5}, {"poisson_ratio", 0.4}}), trap},
      {}};
  MotionHistory history = RestHistory(model);
  Stepper stepper(model, {.scheme = TimeScheme::kBdf2});
  const double rate = std::sqrt(kRate * kRate - kDamping * kDamping);
  double worst = 0;
  for (int k = 1; k <= 400; ++k) {
    ASSERT_TRUE(stepper.Step(kStep, {}, &history).IsUsable());
    const double centre =
        history.position.reshaped(3, body->NodeCount()).row(0).dot(body->node_mass) /
        body->node_mass.sum();
    const double t = k * kStep;
    const double expected =
        kStart *
        (std::exp(-kDamping * t) * (std::cos(rate * t) + kDamping / rate * std::sin(rate * t)) - 1);
    worst = std::max(worst, std::abs(centre - expected));
  }
  // BDF2: its phase lags by (ω h)²/3 ω t = 1e-3, its first, Euler, step by ½ (ω h)² = 2e-4.
  EXPECT_LT(worst, 2e-3 * kStart);
  EXPECT_GT(worst, 0);
}

// What is said when a step with this force along y is tried, which must fail.
std::string SaidInAFailedStep(const std::string& force) {
  const auto body = std::make_shared<Body>(
      MakeBody(BoxMesh({0.125, 0, 0}, {0.145, 0.01, 0.01}, {2, 1, 1}), 1000));
  const Model model{body,
                    {MakeEffect("neo_hookean", {{"young_modulus", 1e5}, {"poisson_ratio", 0.4}}),
                     MakeLaw("mass", "[0, " + force + ", 0]", "2 N/kg")},
                    {}};
  MotionHistory history = RestHistory(model);
  Stepper stepper(model, {});
  testing::internal::CaptureStderr();
  const StepSummary step = stepper.Step(0.01, {}, &history);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_FALSE(step.IsUsable());
  EXPECT_EQ(history.time, 0);
  EXPECT_EQ(said.find("law: "), said.rfind("law: ")) << "said once";
  return said;
}

TEST(ExpressionForce, SaysWhereItIsNotDefinedAndFailsTheStep) {
  EXPECT_THAT(SaidInAFailedStep("-k*log(x - 0.13)"),
              HasSubstr("law: force[1], \"-k*log(x - 0.13)\", is not a number at node 0, where "
                        "x = 0.125, k = 2 (SI)"));
  EXPECT_THAT(SaidInAFailedStep("k/(x - 0.125)"), HasSubstr("is infinite at node 0"));
  EXPECT_THAT(SaidInAFailedStep("k*sqrt(x - 0.125)"),
              HasSubstr("law: the derivative of the force by place or velocity is not finite at "
                        "node 0, where x = 0.125, k = 2 (SI)"));
}

TEST(ExpressionForce, IsDocumentedWithLawsThatWork) {
  std::ifstream stream(std::string(LACUNA_SOURCE_DIR) + "/docs/expression.md");
  ASSERT_TRUE(stream);
  std::string yaml, line;
  int laws = 0;
  for (bool inside = false; std::getline(stream, line);) {
    if (line == "```yaml") {
      inside = true;
      yaml.clear();
    } else if (line == "```" && inside) {
      inside = false;
      const Config config = Config::Parse(yaml, "expression.md");
      for (const char* list : {"effects", "candidates"})
        for (const Config& item : config.Items(list)) {
          EXPECT_THAT(MakeEffect(item)->Card().type, AnyOf("expression", "swelling_field"));
          ++laws;
        }
      config.RefuseUnknownKeys();
    } else if (inside) {
      yaml += line + "\n";
    }
  }
  EXPECT_EQ(laws, 6);
  const std::string piece = std::string(LACUNA_SOURCE_DIR) + "/configs/effects/magnet.yaml";
  EXPECT_THAT(MakeEffect(Config::Load(piece))->Card().title, HasSubstr("magnet"));
}

std::string ErrorOf(const std::string& text) {
  try {
    FromYaml(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

// The magnet with one part of its text replaced.
std::string Changed(const std::string& from, const std::string& to) {
  std::string text = kMagnet;
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(ExpressionForce, RefusesWhatItCannotUse) {
  const std::tuple<const char*, const char*, const char*> cases[] = {
      {"(z - z0)", "(zz - z0)",
       "a.yaml:4:19: force[2]: \"-k * exp(-(zz - z0)/d)\", column 12: unknown name \"zz\"; did you "
       "mean \"z\"?"},
      {"[\"0\", ", "[", "a.yaml:4:8: force: got 2 entries; expected three expressions"},
      {"\"0\", ", "min(x, 1), ", "force: got 4 entries; expected three expressions"},
      {"per: mass", "per: weight",
       "a.yaml:3:6: per: got \"weight\"; expected one of: mass, volume, area"},
      {"name: magnet", "nam: magnet", "a.yaml:1:1: name: is missing (\"nam\" is not a known key)"},
      {"z0: {value: 20 mm, setting: true}", "z0: 20 mm", "parameters.z0: expected a mapping"},
      {"z0: {value: 20 mm", "z0: {value: 20 mmm",
       "parameters.z0.value: got \"20 mmm\" (unknown unit \"mmm\")"},
      {", setting: true", "",
       "parameters.z0.plausible: expected the smallest and the largest plausible value, e.g. "
       "[-10 m, 10 m]"},
      {"setting:", "settng:", "parameters.z0.plausible"},
      {"meaning:", "maening:",
       "a.yaml:7:54: parameters.k.maening: unknown key; did you mean \"meaning\"?"},
      {"[-10 N/kg, 10 N/kg]", "[10 N/kg, -10 N/kg]",
       "a.yaml:7:33: parameters.k.plausible: expected the smallest"},
      {"[-10 N/kg, 10 N/kg]", "[-10 N/kg]", "parameters.k.plausible: expected the smallest"},
      {"[-10 N/kg, 10 N/kg]", "[-10 N, 10 N]",
       "parameters.k.plausible[0]: got \"-10 N\" (its unit has another dimension); expected an "
       "acceleration"},
      {"[-10 N/kg, 10 N/kg]", "[-10 N/kg, 10 N/kg], null_value: 1 mm",
       "parameters.k.null_value: got \"1 mm\" (its unit has another dimension)"},
      {"[-10 N/kg, 10 N/kg]", "[1 N/kg, 10 N/kg], min: 1 N/kg",
       "parameters.k: the null value 0 of the amplitude is out of its bounds"},
      {"[1 mm, 20 cm]", "[0, 20 cm]", "parameters.d.plausible"},
      {"[1 mm, 20 cm]", "[1 mm, 20 cm], max: 10 cm",
       "parameters.d.plausible[1]: got \"20 cm\"; expected a length in"},
      {"[1 mm, 20 cm], min: 0.1 mm, log_scale: true", "[0, 20 cm], min: 0.1 mm",
       "parameters.d.plausible[0]: got \"0\"; expected a length ≥ 0.0001 m"},
      {"[1 mm, 20 cm], min: 0.1 mm", "[0, 20 cm]",
       "parameters.d.plausible[0]: got \"0\"; expected a length > 0"},
      {"50 mm, plausible: [1 mm, 20 cm], min: 0.1 mm", "0 mm, plausible: [1 mm, 20 cm]",
       "parameters.d.value: got \"0 mm\"; expected a length > 0"},
      {"min: 0.1 mm", "min: 0.1 mm, max: 0.1 mm", "parameters.d.max: expected a value above min"},
      {"50 mm", "0.05 mm", "parameters.d.value: got \"0.05 mm\"; expected a length ≥ 0.0001 m"},
      {"  k:", "  z-0:", "parameters.z-0: expected a name of letters, digits and underscores"},
      {"  d:", "  ux:", "parameters.ux: this name has another meaning in an expression"},
      {"  d:", "  exp:", "parameters.exp: this name has another meaning in an expression"},
      {"/d", "", "a.yaml:8:6: parameters.d: does not occur in any of the three expressions"},
      {"k * exp", "k^2 * exp",
       "force: must grow in proportion to k, the amplitude, where that is 0"},
      {"\"0\", \"0\"", "\"0\", \"3 + k\"",
       "a.yaml:4:14: force[1]: \"3 + k\" must vanish when k, the amplitude, is 0, but is 3 at"},
      {"parameters:", "amplitude: z0\nparameters:", "amplitude: got \"z0\"; expected one of: k, d"},
      {"parameters:", "amplitude: d\nparameters:",
       "parameters.d: the null value 0 of the amplitude is out of its bounds"},
  };
  for (const auto& [from, to, message] : cases)
    EXPECT_THAT(ErrorOf(Changed(from, to)), HasSubstr(message)) << from << " -> " << to;
  EXPECT_THAT(ErrorOf("type: expression\nname: a\nper: mass\nforce: [0, 0, 0]\n"),
              HasSubstr("parameters: is missing"));
  EXPECT_THAT(ErrorOf("type: expression\nname: a\nper: mass\nforce: [q, 0, 0]\n"
                      "parameters: {q: {value: 1, setting: true}}\n"),
              HasSubstr("parameters: expected at least one that is not a setting: the amplitude"));
  std::string many = "type: expression\nname: a\nper: mass\nforce: [0, 0, 0]\nparameters:\n";
  for (int k = 0; k < 17; ++k) many += "  k" + std::to_string(k) + ": {value: 1}\n";
  EXPECT_THAT(ErrorOf(many), HasSubstr("parameters: expected at most 16"));
}

}  // namespace
}  // namespace lacuna
