// Scenes of SOFA, MuJoCo and USD. These programs are not at hand: the tests check the text, that of
// USD against the rules of the format.
#include "exchange/scene_writers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "core/error.h"
#include "exchange/cantilever.h"
#include "exchange/missing_parts.h"
#include "exchange/usd_layer.h"
#include "exchange/usd_rules.h"
#include "exchange/xml_element.h"
#include "support/replace_in_file.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

Cantilever Pulled(int order) {
  Cantilever bar("st_venant_kirchhoff", {2, 1, 1}, order);
  bar.model.effects.push_back(
      std::make_shared<PrescribedForce>(BoundaryShares(*bar.model.body, bar.Tip()),
                                        [](double) { return Eigen::Vector3d(0, 0, 0.01); }));
  bar.model.effects.push_back(MakeEffect("mass_damping", {{"alpha", 2}}));
  bar.names.loads = {"pull"};
  bar.frames = {0.1};
  return bar;
}

TEST(WithLinearElements, KeepsCornersMassAndLoad) {
  const PortableModel quadratic = Pulled(2).Describe();
  const PortableModel linear = WithLinearElements(quadratic);
  const TetMesh expected = BoxMesh({0, 0, 0}, {0.08, 0.02, 0.02}, {2, 1, 1});
  EXPECT_EQ(linear.mesh.nodes, expected.nodes);
  EXPECT_EQ(linear.mesh.tets, expected.tets);
  EXPECT_NEAR(linear.node_mass.sum(), quadratic.node_mass.sum(), 1e-15);
  EXPECT_NEAR(linear.loads[0].shares.sum(), 1, 1e-12);
  for (const int node : linear.loads[0].part.nodes) EXPECT_EQ(linear.mesh.nodes(0, node), 0.08);
  EXPECT_EQ(linear.grips[0].part.nodes.size(), 4u);
}

TEST(SofaWriter, WritesTheLawAndNamesWhatIsMissing) {
  EXPECT_THAT(MissingParts(SofaCounterparts(Pulled(1).Describe())),
              ElementsAre("equilibrium at the start"));
  EXPECT_THAT(MissingParts(SofaCounterparts(Pulled(2).Describe())),
              ElementsAre("quadratic elements", "equilibrium at the start"));
  const std::string text = SofaText(Pulled(1).Describe());
  // μ = 1e5/2.8, λ = 1e5·0.4/(1.4·0.2)
  EXPECT_THAT(text, HasSubstr("materialName='StVenantKirchhoff', ParameterSet=[35714.28571428"));
  EXPECT_THAT(text, HasSubstr("rayleighMass=2, rayleighStiffness=0"));
  EXPECT_THAT(text, HasSubstr("    # clamp\n    body.addObject('FixedProjectiveConstraint', "
                              "indices=[0, 3, 6, 9]"));
  EXPECT_THAT(text, HasSubstr("    # pull\n    body.addObject('ConstantForceField'"));
}

// The numbers of the list that follows `key` in its line.
std::vector<double> NumbersBehind(const std::string& key, const std::string& text) {
  const size_t at = text.find(key);
  EXPECT_NE(at, std::string::npos) << key;
  if (at == std::string::npos) return {};
  std::string list = text.substr(at + key.size(), text.find('\n', at) - at - key.size());
  std::replace_if(
      list.begin(), list.end(), [](char letter) { return std::strchr("[],)", letter) != nullptr; },
      ' ');
  std::istringstream stream(list);
  return {std::istream_iterator<double>(stream), {}};
}

// SOFA's law is μ/2 (F:F − 3) − μ ln J + λ/2 (ln J)²: its second parameter is λ, not the bulk
// modulus. μ = 1e5/2.8, λ = 1e5·0.4/(1.4·0.2).
TEST(SofaWriter, GivesTheNeoHookeanLawItsLameConstants) {
  const PortableModel model = Cantilever("neo_hookean", {2, 1, 1}, 1).Describe();
  const std::string text = SofaText(model);
  const std::vector<double> constants =
      NumbersBehind("materialName='NeoHookean', ParameterSet=", text);
  ASSERT_EQ(constants.size(), 2u);
  EXPECT_NEAR(constants[0], 1e5 / 2.8, 1e-9);  // Pa, rounding
  EXPECT_NEAR(constants[1], 1e5 * 0.4 / (1.4 * 0.2), 1e-9);
  // So the energies differ by less than their third-order terms: in a uniform stretch by s, F:F =
  // 3 s² and J = s³. A second parameter that is off by 2/3 μ makes 3 μ e², of second order in e.
  for (const double stretch : {1 - 1e-3, 1 + 1e-3}) {
    const double mu = constants[0], lambda = constants[1];
    const double volume = std::pow(stretch, 3), log = std::log(volume);
    const double invariant = 1.5 * mu * (stretch * stretch - 1);
    const double sofa = invariant - mu * log + lambda / 2 * log * log;
    const double lacuna =
        invariant - mu * (volume - 1) + (lambda + mu) / 2 * (volume - 1) * (volume - 1);
    EXPECT_NEAR(sofa, lacuna, 20 * (lambda + mu) * 1e-9);  // 13.5 λ e³ and 9 μ e³ at most
  }
}

// A constraint of SOFA lets its nodes go at the last key time, and at once where it has one only.
TEST(SofaWriter, HoldsAGripAfterItsMotion) {
  Cantilever bar = LoadedCantilever("linear", 1);
  for (const bool moves : {true, false}) {
    if (!moves) bar.frames.clear();
    const PortableModel model = bar.Describe();
    ASSERT_EQ(model.times.size(), moves ? 5u : 1u);
    const std::string text = SofaText(model);
    const std::vector<double> times = NumbersBehind("keyTimes=", text),
                              movements = NumbersBehind("movements=", text);
    ASSERT_EQ(times.size(), model.times.size() + 1);
    ASSERT_EQ(movements.size(), 3 * times.size());
    for (size_t k = 0; k < model.times.size(); ++k) {
      EXPECT_EQ(times[k], model.times[k]);
      // The middle moves by 0.01 m/s along y.
      EXPECT_NEAR(movements[3 * k + 1], 0.01 * model.times[k], 1e-15);
    }
    EXPECT_GT(times.back(), 1e6);  // s
    for (size_t axis = 0; axis < 3; ++axis)
      EXPECT_EQ(movements[movements.size() - 3 + axis], movements[movements.size() - 6 + axis]);
  }
}

TEST(SofaWriter, WritesValidPython) {
  if (std::system("python3 --version >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "skipped, python3 absent";
  TemporaryFolder folder;
  PortableModel model = Pulled(2).Describe();
  model.grips[0].part.name = "clamp\nraise ValueError";
  std::ofstream(folder / "model.py") << SofaText(model);
  const std::string command = "python3 " + (folder / "model.py").string();
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST(MujocoWriter, PinsTheClampAndNamesWhatIsMissing) {
  EXPECT_THAT(MissingParts(MujocoCounterparts(Pulled(1).Describe())),
              ElementsAre("mass_damping", "force pull", "equilibrium at the start"));
  const std::string text = MujocoText(Pulled(2).Describe());
  EXPECT_THAT(text, HasSubstr("<!-- clamp -->\n      <pin id=\"0 3 6 9\"/>"));
  EXPECT_EQ(ReadXml(text).name, "mujoco");
  EXPECT_THAT(text, HasSubstr("gravity=\"0 0 -9.81\""));
  // μ = 1e5/2.8 and λ/2 = 2 μ, hence ν = 1/3 and E = 8/3 μ.
  const XmlElement scene = ReadXml(text);
  const XmlElement& elasticity = *scene.Find("worldbody")->Find("flexcomp")->Find("elasticity");
  EXPECT_NEAR(std::stod(elasticity.Attribute("young")), 8.0 / 3 * 1e5 / 2.8, 1e-9);
  EXPECT_NEAR(std::stod(elasticity.Attribute("poisson")), 1.0 / 3, 1e-15);
  EXPECT_EQ(elasticity.Attribute("damping"), "0");
}

double MujocoTimeStep(const PortableModel& model) {
  return std::stod(ReadXml(MujocoText(model)).Find("option")->Attribute("timestep"));
}

// A single tetrahedron with corners at 0 and at h on the axes, h = 0.01 m: V = h³/6; its faces have
// the areas h²/2, three times, and √3 h²/2, so that the largest A_i Σ A / (9 V m) is
// √3/2 (3 + √3)/2 h⁴ / (1.5 h³ m), with the mass of a node m = 1000 V/4. Without damping,
// Δt = 2/ω, ω² = (λ + 2μ) times this.
TEST(MujocoWriter, WritesAStableTimeStep) {
  PortableModel model = Cantilever("linear", {2, 1, 1}, 1).Describe();
  const double h = 0.01, mass = 1000 * h * h * h / 24;
  model.mesh.nodes = Eigen::Matrix3Xd::Zero(3, 4);
  model.mesh.nodes.rightCols<3>() = h * Eigen::Matrix3d::Identity();
  model.mesh.tets = Eigen::Vector4i(0, 1, 2, 3);
  model.node_mass = Eigen::Vector4d::Constant(mass);
  model.time_step = 1;
  model.grips.clear();
  const double stiffness = 1e5 * 0.6 / (1.4 * 0.2);  // λ + 2μ
  const double frequency =
      std::sqrt(stiffness * std::sqrt(3) * (3 + std::sqrt(3)) / 4 * h / (1.5 * mass));
  EXPECT_NEAR(MujocoTimeStep(model), 2 / frequency, 1e-9);
  model.time_step = 1e-6;
  EXPECT_EQ(MujocoTimeStep(model), 1e-6);
  // With much damping, Δt = 2/(β ω²).
  model.time_step = 1;
  model.effects.push_back({PortableEffect::Kind::kStiffnessDamping,
                           "stiffness_damping",
                           Eigen::Vector3d(10, 1e5, 0.4),
                           {},
                           {}});
  EXPECT_NEAR(MujocoTimeStep(model), 2 / (10 * frequency * frequency), 1e-12);
}

std::vector<Eigen::Vector3d> Vectors(const UsdPrim& prim, const std::string& property) {
  std::vector<Eigen::Vector3d> vectors;
  for (const UsdValue& item : prim.Find(property)->value.items)
    vectors.emplace_back(item.items[0].number, item.items[1].number, item.items[2].number);
  return vectors;
}

TEST(UsdWriter, FollowsTheRulesOfTheFormat) {
  for (const char* law : {"linear", "neo_hookean"})
    for (const int order : {1, 2})
      EXPECT_THAT(UsdFaults(UsdText(LoadedCantilever(law, order).Describe())), IsEmpty())
          << law << ", " << order;
  // A model without frames, and names that USD does not allow or that stand twice.
  Cantilever still("linear", {2, 1, 1}, 1);
  still.names.grips = {"body"};
  still.names.regions = {{"52 g", {1}}, {"52-g", {2}}, {"\"\\\n", {}}};
  EXPECT_THAT(UsdFaults(UsdText(still.Describe())), IsEmpty());
}

// A rule that is broken is found, so that the test above means something.
TEST(UsdRules, FindWhatIsBroken) {
  const std::string good = UsdText(LoadedCantilever("linear", 1).Describe());
  const std::pair<std::string, std::string> breaks[] = {
      {"#usda 1.0", "#usda 1.1"},
      {"defaultPrim = \"lacuna\"", "defaultPrim = \"body\""},
      {"upAxis = \"Z\"", ""},
      {"metersPerUnit", "meterPerUnit"},
      {"kilogramsPerUnit = 1", ""},
      {"endTimeCode = 0.2", "endTimeCode = 0.1"},
      {"def TetMesh", "def Mesh"},
      {", \"MaterialBindingAPI\"", ""},
      {"\"PhysicsDeformableBodyAPI\"", "\"PhysicsSoftBodyAPI\""},
      {"physics:youngsModulus", "physics:youngModulus"},
      {"physics:poissonsRatio = 0.4", "physics:poissonsRatio = 0.6"},
      {"physics:density = 1000", "physics:density = 0"},
      {"</lacuna/material>", "</material>"},
      {"physics:src0 = </lacuna/body>", "physics:src0 = </lacuna/scene>"},
      {"float3[] extent = [(0, ", "float3[] extent = [(0.01, "},
      {"point3f[] points = [(0, 0, 0)", "point3f[] points = [(0, 0)"},
      {"point3f[] points = [(0, 0, 0)", "point3f[] points = [(0.1, 0.1, 0.1)"},
      {"point3f[] points", "float3[] points"},
      {"int4[] tetVertexIndices = [(0, ", "int4[] tetVertexIndices = [(99, "},
      {"int4[] tetVertexIndices = [(0, 1, ", "int4[] tetVertexIndices = [(1, 0, "},
      {"int3[] surfaceFaceVertexIndices = [(", "int3[] surfaceFaceVertexIndices = [(0, 1, 2), ("},
      {"indices = [0, 3, 6, 9]", "indices = [0, 3, 6, 12]"},
      {"indices = [0, 3, 6, 9]", "indices = [0, 3, 6, 6]"},
      {"elementType = \"point\"", "elementType = \"face\""},
      {"physics:indices0 = [0, ", "physics:indices0 = ["},
      {"def GeomSubset \"turned\"", "def GeomSubset \"clamp\""},
      {"def GeomSubset \"turned\"", "def GeomSubset \"turned tip\""},
      {"            0.05: ((1, ", "            0.05: ((2, "},
      {"            0.05: ", "            0: "},
      {"uniform token[] xformOpOrder = [\"xformOp:transform\"]", ""}};
  for (const auto& [from, to] : breaks) {
    EXPECT_THAT(UsdFaults(WithReplacements(good, {{from, to}})), Not(IsEmpty()))
        << from << " to " << to;
  }
}

TEST(UsdWriter, WritesMeshMaterialAndScene) {
  const PortableModel model = Pulled(1).Describe();
  const UsdLayer layer = ReadUsd(UsdText(model));
  const UsdPrim& body = *layer.Find("/lacuna/body");
  const std::vector<Eigen::Vector3d> points = Vectors(body, "points");
  ASSERT_EQ(points.size(), static_cast<size_t>(model.mesh.NodeCount()));
  // Single precision.
  for (size_t n = 0; n < points.size(); ++n)
    EXPECT_LT((points[n] - model.mesh.nodes.col(static_cast<Eigen::Index>(n))).norm(), 1e-8);
  EXPECT_EQ(body.Find("tetVertexIndices")->value.Numbers().size(),
            static_cast<size_t>(4 * model.mesh.TetCount()));
  const UsdPrim& material = *layer.Find("/lacuna/material");
  EXPECT_EQ(material.Find("physics:youngsModulus")->value.number, 1e5);
  EXPECT_EQ(material.Find("physics:poissonsRatio")->value.number, 0.4);
  EXPECT_EQ(material.Find("physics:density")->value.number, 1000);
  EXPECT_EQ(layer.Find("/lacuna/scene")->Find("physics:gravityMagnitude")->value.number, 9.81);
  EXPECT_EQ(Vectors(*layer.Find("/lacuna/body"), "extent")[1], Eigen::Vector3d(0.08, 0.02, 0.02));
  const UsdPrim& clamp = *layer.Find("/lacuna/body/clamp");
  EXPECT_THAT(clamp.Find("indices")->value.Numbers(), ElementsAre(0, 3, 6, 9));
  EXPECT_EQ(clamp.metadata.at("displayName").text, "clamp");
  EXPECT_EQ(layer.Find("/lacuna")->Find("lacuna:effect1:young_modulus")->value.number, 1e5);
  EXPECT_THAT(MissingParts(UsdCounterparts(model)),
              ElementsAre("mass_damping", "force pull", "equilibrium at the start"));
}

// Without this a simulator would assume the gravity of the earth.
TEST(UsdWriter, WritesThatThereIsNoGravity) {
  Cantilever bar("linear", {2, 1, 1}, 1);
  bar.model.effects.pop_back();
  EXPECT_EQ(ReadUsd(UsdText(bar.Describe()))
                .Find("/lacuna/scene")
                ->Find("physics:gravityMagnitude")
                ->value.number,
            0);
}

// The frame carries the points of an attachment from their rest positions to those of the grip.
TEST(UsdWriter, MovesGripsAsTheRecordingDoes) {
  const PortableModel model = LoadedCantilever("linear", 1).Describe();
  const UsdLayer layer = ReadUsd(UsdText(model));
  for (const PortableGrip& grip : {model.grips[1], model.grips[2]}) {
    const UsdPrim& frame = *layer.Find("/lacuna/" + grip.part.name);
    EXPECT_TRUE(frame.Has("PhysicsRigidBodyAPI"));
    EXPECT_EQ(frame.Find("physics:kinematicEnabled")->value.number, 1);
    const std::vector<Eigen::Vector3d> rest = Vectors(frame.children[0], "physics:coords1");
    const UsdValue& motion = frame.Find("xformOp:transform")->value;
    ASSERT_EQ(motion.times, model.times);
    for (size_t k = 0; k < motion.times.size(); ++k) {
      const std::vector<double> matrix = motion.items[k].Numbers();
      for (size_t n = 0; n < rest.size(); ++n) {
        const auto column = static_cast<Eigen::Index>(n);
        const Eigen::RowVector4d moved =
            rest[n].homogeneous().transpose() *
            Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(matrix.data());
        const Eigen::Vector3d expected =
            model.mesh.nodes.col(grip.part.nodes[n]) + grip.displacements[k].col(column);
        // Single precision of the rest positions.
        EXPECT_LT((moved.head<3>().transpose() - expected).norm(), 1e-8);
      }
    }
  }
}

TEST(UsdWriter, NamesMotionsThatAreNotRigid) {
  Cantilever bar = LoadedCantilever("linear", 1);
  const Eigen::Matrix3Xd tip = bar.mesh.nodes(Eigen::all, bar.Tip());
  bar.model.grips[1].motion = [tip](double time) -> Eigen::Matrix3Xd { return (1 + time) * tip; };
  bar.model.grips[2].axes = AxisSet::Of(1);
  const PortableModel model = bar.Describe();
  EXPECT_THAT(MissingParts(UsdCounterparts(model)),
              ElementsAre("grip turned", "grip moved", "force weight", "force pull", "hold",
                          "equilibrium at the start"));
  EXPECT_THAT(UsdFaults(UsdText(model)), IsEmpty());
  EXPECT_EQ(ReadUsd(UsdText(model)).Find("/lacuna/turned"), nullptr);
}

TEST(UsdWriter, RefusesALawThatItCannotDescribe) {
  PortableModel model = Pulled(1).Describe();
  model.effects.front().kind = PortableEffect::Kind::kOther;
  EXPECT_THROW(UsdText(model), InputError);
}

TEST(SceneWriters, SayThatTheTimeSchemeIsAnother) {
  const auto kind = [](const Counterparts& parts) {
    const auto found = std::find_if(parts.begin(), parts.end(),
                                    [](const Counterpart& part) { return part.part == "inertia"; });
    EXPECT_NE(found, parts.end());
    return found == parts.end() ? Counterpart::Kind::kNone : found->kind;
  };
  const PortableModel model = Pulled(1).Describe();
  EXPECT_EQ(kind(SofaCounterparts(model)), Counterpart::Kind::kConverted);
  EXPECT_EQ(kind(MujocoCounterparts(model)), Counterpart::Kind::kConverted);
  EXPECT_EQ(kind(UsdCounterparts(model)), Counterpart::Kind::kConverted);
}

TEST(SceneWriters, NameTheHoldThatTheyLose) {
  for (const int order : {1, 2}) {
    const PortableModel model = LoadedCantilever("linear", order).Describe();
    EXPECT_THAT(MissingParts(SofaCounterparts(model)), testing::Contains("hold"));
    EXPECT_THAT(MissingParts(MujocoCounterparts(model)), testing::Contains("hold"));
    EXPECT_THAT(MissingParts(UsdCounterparts(model)), testing::Contains("hold"));
  }
}

// A plane of symmetry has a counterpart in SOFA and none in MuJoCo, which says so.
TEST(SceneWriters, HoldAlongSomeAxesWhereTheyCan) {
  Cantilever bar = Pulled(1);
  bar.model.grips[0].axes = AxisSet::Of(0);
  const PortableModel model = bar.Describe();
  EXPECT_THAT(SofaText(model),
              HasSubstr("'PartialFixedProjectiveConstraint', indices=[0, 3, 6, 9],\n"
                        "                   fixedDirections=[1, 0, 0])"));
  EXPECT_THAT(MissingParts(MujocoCounterparts(model)), testing::Contains("grip clamp"));
  EXPECT_THAT(MujocoText(model), Not(HasSubstr("<pin")));
}

}  // namespace
}  // namespace lacuna
