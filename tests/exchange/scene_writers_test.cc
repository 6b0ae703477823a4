// Scenes of SOFA, MuJoCo and USD. These programs are not at hand: the tests check the text.
#include "exchange/scene_writers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "exchange/cantilever.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::vector<std::string> Names(const Counterparts& parts) {
  std::vector<std::string> names;
  for (const Counterpart& part : Missing(parts)) names.push_back(part.part);
  return names;
}

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
  EXPECT_THAT(Names(SofaCounterparts(Pulled(1).Describe())),
              ElementsAre("equilibrium at the start"));
  EXPECT_THAT(Names(SofaCounterparts(Pulled(2).Describe())),
              ElementsAre("quadratic elements", "equilibrium at the start"));
  const std::string text = SofaText(Pulled(1).Describe());
  // μ = 1e5/2.8, λ = 1e5·0.4/(1.4·0.2)
  EXPECT_THAT(text, HasSubstr("materialName='StVenantKirchhoff', ParameterSet=[35714.28571428"));
  EXPECT_THAT(text, HasSubstr("rayleighMass=2, rayleighStiffness=0"));
  EXPECT_THAT(text, HasSubstr("'FixedProjectiveConstraint', indices=[0, 3, 6, 9]"));
  EXPECT_THAT(text, HasSubstr("'ConstantForceField'"));
}

TEST(SofaWriter, WritesValidPython) {
  if (std::system("python3 --version >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "skipped, python3 absent";
  TemporaryFolder folder;
  std::ofstream(folder / "model.py") << SofaText(Pulled(2).Describe());
  const std::string command = "python3 -m py_compile " + (folder / "model.py").string();
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST(MujocoWriter, PinsTheClampAndNamesWhatIsMissing) {
  EXPECT_THAT(Names(MujocoCounterparts(Pulled(1).Describe())),
              ElementsAre("mass_damping", "force pull", "equilibrium at the start"));
  const std::string text = MujocoText(Pulled(2).Describe());
  EXPECT_THAT(text, HasSubstr("<pin id=\"0 3 6 9\"/>"));
  EXPECT_THAT(text, HasSubstr("gravity=\"0 0 -9.81\""));
  EXPECT_THAT(text, HasSubstr("<elasticity young=\"100000\" poisson=\"0.4\" damping=\"0\"/>"));
}

TEST(UsdWriter, WritesTheMesh) {
  const std::string text = UsdText(Pulled(1).Describe());
  EXPECT_THAT(text, HasSubstr("#usda 1.0\n"));
  EXPECT_THAT(text, HasSubstr("point3f[] points = [(0, 0, 0), (0.04, 0, 0), (0.08, 0, 0)"));
  EXPECT_THAT(text, HasSubstr("custom int[] lacuna:nodes:CLAMP = [0, 3, 6, 9]"));
  EXPECT_THAT(text, HasSubstr("custom double lacuna:effect1:young_modulus = 100000"));
  EXPECT_THAT(
      Names(UsdCounterparts(Pulled(1).Describe())),
      ElementsAre("st_venant_kirchhoff", "gravity", "mass_damping", "grip clamp", "force pull"));
}

// A plane of symmetry has a counterpart in SOFA and none in MuJoCo, which says so.
TEST(SceneWriters, HoldAlongSomeAxesWhereTheyCan) {
  Cantilever bar = Pulled(1);
  bar.model.grips[0].axes = AxisSet::Of(0);
  const PortableModel model = bar.Describe();
  EXPECT_THAT(SofaText(model),
              HasSubstr("'PartialFixedProjectiveConstraint', indices=[0, 3, 6, 9],\n"
                        "                   fixedDirections=[1, 0, 0])"));
  EXPECT_THAT(Names(MujocoCounterparts(model)), testing::Contains("grip clamp"));
  EXPECT_THAT(MujocoText(model), Not(HasSubstr("<pin")));
}

}  // namespace
}  // namespace lacuna
