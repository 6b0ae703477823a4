// The Gmsh files and the JSON beside them.
#include "exchange/model_json.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/config.h"
#include "effects/effect_text.h"
#include "effects/uniform_density.h"
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

// Reads model.msh in the folder with Gmsh and writes it as other.msh, with these options.
void Resave(const TemporaryFolder& folder, const std::string& options) {
  const std::string command = "cd " + folder.Path().string() +
                              " && gmsh -v 1 model.msh -save -save_all " + options +
                              " -o other.msh >log 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0) << FileContent(folder / "log");
}

// The nodes in a binary file of version 2.2, which keeps all bits: in the section $Nodes, after
// their number in text, the number of each node (4 bytes) and its coordinates (8 bytes each).
Eigen::Matrix3Xd NodesInBinaryFile(const std::filesystem::path& file) {
  const std::string content = FileContent(file);
  std::istringstream stream(content);
  for (std::string line; line != "$Nodes" && std::getline(stream, line);) continue;
  int count = 0;
  stream >> count;
  stream.get();  // the end of the line
  Eigen::Matrix3Xd nodes = Eigen::Matrix3Xd::Zero(3, count);
  for (int k = 0; k < count && stream; ++k) {
    int32_t number = 0;
    Eigen::Vector3d node;
    stream.read(reinterpret_cast<char*>(&number), sizeof number);
    stream.read(reinterpret_cast<char*>(node.data()), 3 * sizeof(double));
    if (number >= 1 && number <= count) nodes.col(number - 1) = node;
  }
  EXPECT_TRUE(stream.good());
  return nodes;
}

// What is left of the coordinates where they are written with 16 significant digits.
Eigen::Matrix3Xd With16Digits(const Eigen::Matrix3Xd& nodes) {
  return nodes.unaryExpr([](double x) { return std::stod(fmt::format("{:.16g}", x)); });
}

// Gmsh reads all bits of either version: it writes the same bits into a binary file, and the digits
// that it writes into a text file of the other version are theirs.
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
      Resave(folder, "-bin -format msh22");
      EXPECT_EQ(NodesInBinaryFile(folder / "other.msh"), mesh.nodes);
      Resave(folder, is_4 ? "-format msh22" : "-format msh41");
      const TetMeshFile read = ReadTetMesh(folder / "other.msh");
      EXPECT_EQ(read.mesh.tets, mesh.tets);
      EXPECT_EQ(read.mesh.nodes, With16Digits(mesh.nodes));
      EXPECT_NE(read.mesh.nodes, mesh.nodes) << "16 digits would do for this mesh";
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

// What is written with expressions is in their parameters only in part: the mapping makes the same
// effect again.
TEST(ModelJson, HoldsTheExpressionsOfAnEffect) {
  Cantilever bar("neo_hookean", {2, 1, 1}, 1);
  for (const char* yaml :
       {"{type: swelling_field, strain: 0.1 %, field: \"1 + Z/0.02\"}",
        "{type: expression, name: magnet, per: mass, force: [0, 0, \"-k * z/0.01\"], parameters: "
        "{k: {value: 3 N/kg, plausible: [0 N/kg, 10 N/kg]}}}"})
    bar.model.effects.push_back(MakeEffect(Config::Parse(yaml, "a.yaml")));
  const PortableModel model = bar.Describe();
  EXPECT_TRUE(Missing(JsonCounterparts(model)).empty());
  const auto json = nlohmann::json::parse(ModelJson(model, "model.msh").dump());
  EXPECT_FALSE(json.at("effects").at(1).contains("yaml"));
  for (const size_t k : {2u, 3u}) {
    const nlohmann::json& effect = json.at("effects").at(k);
    const std::string yaml = effect.at("yaml");
    const auto again = MakeEffect(Config::Parse(yaml, "b.yaml"));
    EXPECT_EQ(FormatEffect(*again), FormatEffect(*bar.model.effects[k]));
    EXPECT_EQ(effect.at("parameters").front().get<double>(), again->Parameters()[0]);
  }
  EXPECT_THAT(json.at("effects").at(2).at("yaml").get<std::string>(),
              testing::HasSubstr("1 + Z/0.02"));
}

TEST(ModelJson, HasTheDensityThatWasFitted) {
  Cantilever bar("neo_hookean", {2, 1, 1}, 1);
  bar.model.effects.push_back(MakeEffect("mass_damping", {{"alpha", 5}}));
  const double mass = bar.Describe().node_mass.sum();
  bar.model.effects.push_back(MakeUniformDensity(1250, {0, 0, -9.81}));
  const PortableModel model = bar.Describe();
  EXPECT_EQ(model.density, 1250);
  EXPECT_NEAR(model.node_mass.sum(), 1.25 * mass, 1e-12);  // kg, rounding
  ASSERT_EQ(model.effects.size(), 3u);
  EXPECT_NEAR(model.Damping().alpha, 4, 1e-12);  // the same force per velocity
  EXPECT_TRUE(Missing(JsonCounterparts(model)).empty());
}

TEST(ModelJson, HasTheValueThatAnIntervalBelongsTo) {
  PortableModel model = Cantilever("linear", {2, 1, 1}, 1).Describe();
  model.parameters = {{"young_modulus", "Pa", {29000}, true, 40000, 142000, 75000},
                      {"poisson_ratio", "", {0.4}, true, 0.3, 0.45}};
  const auto json = ModelJson(model, "model.msh");
  EXPECT_EQ(json.at("fit").at(0).at("value"), 29000);
  EXPECT_EQ(json.at("fit").at(0).at("at_limit"), 75000);
  EXPECT_FALSE(json.at("fit").at(1).contains("at_limit"));
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
