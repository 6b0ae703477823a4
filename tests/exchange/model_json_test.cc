// The Gmsh files and the JSON beside them.
#include "exchange/model_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "exchange/cantilever.h"
#include "exchange/export_format.h"
#include "exchange/gmsh_regions.h"
#include "geometry/gmsh_io.h"
#include "geometry/mesh_io.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

TetMesh UnevenMesh(int order) {
  TetMesh mesh = Jittered(BoxMesh({0, 0, 0}, {0.09, 0.03, 0.03}, {3, 2, 2}), 0.03, 0.2, 11);
  mesh.nodes /= 3;
  return order == 2 ? ToQuadratic(mesh) : mesh;
}

TEST(GmshExport, IsReadBackWithTheSameBits) {
  for (const GmshVersion version : {GmshVersion::k22, GmshVersion::k41})
    for (const int order : {1, 2}) {
      TemporaryFolder folder;
      const TetMesh mesh = UnevenMesh(order);
      std::ofstream(folder / "model.msh") << GmshText(mesh, version);
      const TetMeshFile read = ReadTetMesh(folder / "model.msh");
      EXPECT_EQ(read.mesh.nodes, mesh.nodes);
      EXPECT_EQ(read.mesh.tets, mesh.tets);
      EXPECT_TRUE(read.notes.empty());
    }
}

// Gmsh reads either version and writes the other one.
TEST(GmshExport, PassesThroughGmshWithTheSameBits) {
  if (std::system("gmsh --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "skipped, gmsh absent";
  for (const bool is_4 : {false, true})
    for (const int order : {1, 2}) {
      TemporaryFolder folder;
      const TetMesh mesh = UnevenMesh(order);
      PortableModel model;
      model.mesh = mesh;
      model.regions = {{"left \"clamp\"", {0, 2}}, {"tip", {1}}};
      std::ofstream(folder / "model.msh")
          << GmshText(mesh, is_4 ? GmshVersion::k41 : GmshVersion::k22) + GmshRegions(model);
      const std::string command = "cd " + folder.Path().string() +
                                  " && gmsh -v 1 model.msh -save -save_all -format " +
                                  (is_4 ? "msh22" : "msh41") + " -o other.msh >log 2>&1";
      ASSERT_EQ(std::system(command.c_str()), 0) << FileContent(folder / "log");
      const TetMeshFile read = ReadTetMesh(folder / "other.msh");
      EXPECT_EQ(read.mesh.tets, mesh.tets);
      // Gmsh writes 16 significant digits.
      EXPECT_LT((read.mesh.nodes - mesh.nodes).cwiseAbs().maxCoeff(), 1e-17);
    }
}

TEST(GmshExport, HasTheRegionsAsFieldsAndIsReadBackWithTheSameBits) {
  for (const char* format : {"msh", "msh2"})
    for (const int order : {1, 2}) {
      const PortableModel model = LoadedCantilever("linear", order).Describe();
      const std::string text = FindExportFormat(format).files(model).at("model.msh");
      TemporaryFolder folder;
      std::ofstream(folder / "model.msh") << text;
      const TetMeshFile read = ReadTetMesh(folder / "model.msh");
      EXPECT_EQ(read.mesh.nodes, model.mesh.nodes);
      EXPECT_EQ(read.mesh.tets, model.mesh.tets);
      std::istringstream file(text.substr(text.find("$NodeData")));
      for (const NamedNodes& region : model.regions) {
        std::string line;
        for (const std::string& expected :
             {std::string("$NodeData"), std::string("1"), "\"" + region.name + "\"",
              std::string("1"), std::string("0"), std::string("3"), std::string("0"),
              std::string("1"), std::to_string(model.mesh.NodeCount())}) {
          std::getline(file, line);
          EXPECT_EQ(line, expected);
        }
        std::vector<int> nodes;
        for (int node = 0; node < model.mesh.NodeCount(); ++node) {
          int number = 0, is_inside = 0;
          file >> number >> is_inside;
          EXPECT_EQ(number, node + 1);
          if (is_inside == 1) nodes.push_back(node);
        }
        EXPECT_EQ(nodes, region.nodes);
        std::getline(file, line);
        std::getline(file, line);
        EXPECT_EQ(line, "$EndNodeData");
      }
    }
}

TEST(GmshExport, RefusesTruncatedFiles) {
  TemporaryFolder folder;
  const std::string whole = GmshText(UnevenMesh(1), GmshVersion::k41);
  for (size_t length = 0; length + 5 < whole.size(); length += 61) {
    std::ofstream(folder / "cut.msh", std::ios::binary) << whole.substr(0, length);
    EXPECT_ANY_THROW(ReadTetMesh(folder / "cut.msh")) << length;
  }
}

TEST(ModelJson, HoldsEveryEffectWithAllDigits) {
  Cantilever bar("neo_hookean", {2, 1, 1}, 1);
  const double alpha = 1.0 / 3;
  bar.model.effects.push_back(MakeEffect("mass_damping", {{"alpha", alpha}}));
  bar.frames = {0.1};
  bar.options.held_force = Eigen::VectorXd::Constant(3 * bar.mesh.NodeCount(), 0.1);
  const PortableModel model = bar.Describe();
  EXPECT_TRUE(Missing(JsonCounterparts(model)).empty());
  const auto json = nlohmann::json::parse(ModelJson(model, "model.msh").dump());
  EXPECT_EQ(json.at("effects").at(0).at("type"), "neo_hookean");
  EXPECT_EQ(json.at("effects").at(0).at("parameters").at("poisson_ratio"), 0.4);
  EXPECT_EQ(json.at("effects").at(2).at("parameters").at("alpha").get<double>(), alpha);
  EXPECT_EQ(json.at("regions").at(0).at("nodes").get<std::vector<int>>(),
            model.grips[0].part.nodes);
  EXPECT_EQ(json.at("force_before_the_start").size(), static_cast<size_t>(bar.mesh.NodeCount()));
  EXPECT_EQ(json.at("density"), 1000);
}

TEST(ModelJson, DescribesTranslationsAndTurns) {
  Cantilever bar("linear", {2, 1, 1}, 1);
  const Eigen::Matrix3Xd rest = bar.mesh.nodes(Eigen::all, bar.model.grips[0].nodes);
  bar.model.grips[0].motion = [rest](double time) -> Eigen::Matrix3Xd {
    return rest.colwise() + Eigen::Vector3d(time, 0, 0);
  };
  bar.options.time_step = 1;
  bar.frames = {1, 2};
  const auto json = ModelJson(bar.Describe(), "model.msh");
  EXPECT_EQ(json.at("grips").at(0).at("displacement").size(), 3u);
  EXPECT_NEAR(json.at("grips").at(0).at("displacement").at(2).at(0).get<double>(), 2, 1e-12);
  bar.model.grips[0].motion = [rest](double time) { return Eigen::Matrix3Xd((1 + time) * rest); };
  EXPECT_TRUE(
      ModelJson(bar.Describe(), "model.msh").at("grips").at(0).contains("displacements_of_nodes"));
}

}  // namespace
}  // namespace lacuna
