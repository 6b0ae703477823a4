// The .feb file. FEBio is not at hand: the tests check the text against the rules of the format.
#include "exchange/feb_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>

#include "exchange/cantilever.h"
#include "exchange/feb_rules.h"
#include "exchange/missing_parts.h"
#include "support/replace_in_file.h"

namespace lacuna {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

Cantilever Bar() {
  Cantilever bar("st_venant_kirchhoff", {2, 1, 1}, 2);
  bar.frames = {0.1};
  bar.options.time_step = 0.05;
  return bar;
}

TEST(FebWriter, WritesMeshAndMaterialWithAllDigits) {
  PortableModel model = Bar().Describe();
  model.mesh.nodes(0, 3) = 1.0 / 3;
  const std::string text = FebText(model);
  EXPECT_THAT(text, HasSubstr("<node id=\"4\">0.3333333333333333,"));
  EXPECT_THAT(text, HasSubstr("type=\"isotropic elastic\">\n<density>1000</density><E>100000</E>"
                              "<v>0.4</v>"));
  const auto tet = model.mesh.tets.col(0);
  std::string nodes = "<elem id=\"1\">" + std::to_string(tet[0] + 1);
  for (int k = 1; k < 10; ++k) nodes += "," + std::to_string(tet[k] + 1);
  EXPECT_THAT(text, HasSubstr("<Elements type=\"tet10\""));
  EXPECT_THAT(text, HasSubstr(nodes + "</elem>"));
}

// The weights of all nodes sum to ρ V g = 1000 · 3.2e-5 · 9.81 N.
TEST(FebWriter, WritesTheWeightOfEachNode) {
  const std::string text = FebText(Bar().Describe());
  double sum = 0;
  const size_t end = text.find("</NodeData>");
  for (size_t at = text.find("<node lid="); at < end; at = text.find("<node lid=", at + 1)) {
    int node = 0;
    double weight = 0;
    ASSERT_EQ(std::sscanf(text.c_str() + at, "<node lid=\"%d\">%lf", &node, &weight), 2);
    sum += weight;
  }
  EXPECT_NEAR(sum, -1000 * 3.2e-5 * 9.81, 1e-12);
}

TEST(FebWriter, NamesWhatHasNoCounterpart) {
  Cantilever bar = Bar();
  bar.model.effects.push_back(MakeEffect("mass_damping", {{"alpha", 2}}));
  for (const double poisson : {0.4, 0.3})
    bar.model.effects.push_back(
        MakeEffect("viscoelastic_branch",
                   {{"modulus", 5e4}, {"relaxation_time", 0.04}, {"poisson_ratio", poisson}}));
  const PortableModel model = bar.Describe();
  EXPECT_THAT(MissingParts(FebCounterparts(model)),
              ElementsAre("mass_damping", "viscoelastic_branch"));
  // g = m/E; the first step lasts a thousand relaxation times.
  EXPECT_THAT(FebText(model), HasSubstr("<g1>0.5</g1><t1>0.04</t1>\n<elastic type=\"isotropic"));
  EXPECT_THAT(FebText(model), HasSubstr("<pt>40,1</pt>"));
}

// FEBio's material has g1 to g6.
TEST(FebWriter, NamesTheBranchesThatAreTooMany) {
  Cantilever bar = Bar();
  for (int k = 1; k <= 7; ++k)
    bar.model.effects.push_back(
        MakeEffect("viscoelastic_branch",
                   {{"modulus", 1e4 * k}, {"relaxation_time", 0.01 * k}, {"poisson_ratio", 0.4}}));
  const PortableModel model = bar.Describe();
  EXPECT_THAT(MissingParts(FebCounterparts(model)), ElementsAre("viscoelastic_branch"));
  EXPECT_EQ(FebCounterparts(model).at(7).kind, Counterpart::Kind::kConverted);  // the sixth
  EXPECT_EQ(FebCounterparts(model).at(8).kind, Counterpart::Kind::kNone);
  EXPECT_THAT(FebText(model), HasSubstr("<g6>0.6</g6>"));
  EXPECT_THAT(FebText(model), Not(HasSubstr("<g7>")));
}

PortableModel Everything(const std::string& law, int order) {
  Cantilever bar = LoadedCantilever(law, order);
  bar.model.effects.push_back(
      MakeEffect("viscoelastic_branch",
                 {{"modulus", 5e4}, {"relaxation_time", 0.04}, {"poisson_ratio", 0.4}}));
  return bar.Describe();
}

TEST(FebWriter, FollowsTheRulesOfTheFormat) {
  for (const char* law : {"st_venant_kirchhoff", "neo_hookean", "corotational"})
    for (const int order : {1, 2})
      EXPECT_THAT(FebFaults(FebText(Everything(law, order))), IsEmpty()) << law << ", " << order;
  EXPECT_THAT(FebFaults(FebText(Bar().Describe())), IsEmpty());
  Cantilever still("linear", {2, 1, 1}, 1);
  EXPECT_THAT(FebFaults(FebText(still.Describe())), IsEmpty());
}

// A rule that is broken is found, so that the test above means something.
TEST(FebRules, FindWhatIsBroken) {
  const std::string good = FebText(Everything("neo_hookean", 1));
  const std::pair<std::string, std::string> breaks[] = {
      {"version=\"4.0\"", "version=\"3.0\""},
      {"</Material>", "</Materials>"},
      {"<MeshDomains>", "<Output></Output><MeshDomains>"},
      {"<Mesh>", "<Geometry></Geometry><Mesh>"},
      {"mat=\"lacuna\"", "mat=\"lacuna2\""},
      {"<SolidDomain name=\"elements\"", "<SolidDomain name=\"element\""},
      {"type=\"tet4\"", "type=\"hex8\""},
      {"<node id=\"2\">", "<node id=\"1\">"},
      {"<elem id=\"1\">", "<elem id=\"0\">"},
      {"<NodeSet name=\"clamp\">", "<NodeSet name=\"clump\">"},
      {"<NodeSet name=\"turned\">", "<NodeSet name=\"clamp\">"},
      {"<NodeSet name=\"hold\">6", "<NodeSet name=\"hold\">0"},
      {"lc=\"1\"", "lc=\"1000\""},
      {"type=\"map\">pull_z", "type=\"map\">pull_w"},
      {"<load_controller id=\"2\"", "<load_controller id=\"3\""},
      {"<dof>x</dof>", "<dof>u</dof>"},
      {"<v>0.4</v>", "<v>0.5</v>"},
      {"<v>0.4</v>", "<nu>0.4</nu>"},
      {"<NodeData name=\"weight_z\"", "<NodeData title=\"weight_z\""},
      {"<analysis>STATIC", "<analysis>Static"},
      {"<node lid=\"1\">", "<node lid=\"2\">"}};
  for (const auto& [from, to] : breaks) {
    EXPECT_THAT(FebFaults(WithReplacements(good, {{from, to}})), Not(IsEmpty())) << to;
  }
}

TEST(FebWriter, NamesNodeSetsLikeTheRecording) {
  PortableModel model = Everything("linear", 1);
  EXPECT_THAT(FebText(model), HasSubstr("<NodeSet name=\"clamp\">1,4,7,10</NodeSet>"));
  EXPECT_THAT(FebText(model), HasSubstr("<bc name=\"clamp\" node_set=\"clamp\""));
  EXPECT_THAT(FebText(model), HasSubstr("<NodeData name=\"pull_z\" node_set=\"nodes\""));
  // Names that the format or the file already has, and names that the file cannot hold.
  model.regions[0].name = "a--b <&>\n";
  model.regions[3].name = "nodes";
  model.regions[4].name = "turned_3";
  model.run = "x -- y";
  const std::string text = FebText(model);
  EXPECT_THAT(FebFaults(text), IsEmpty());
  EXPECT_THAT(text, HasSubstr("<!-- \"a-b <&> \" in the recording -->\n"
                              "<NodeSet name=\"a__b_____\">"));
  EXPECT_THAT(text, HasSubstr("<NodeSet name=\"nodes_2\">"));
}

TEST(FebWriter, HoldsPartsAlongTheirAxesOnly) {
  Cantilever bar("st_venant_kirchhoff", {2, 1, 1}, 1);
  bar.model.grips[0].axes = AxisSet::Of(0) | AxisSet::Of(2);
  EXPECT_THAT(FebText(bar.Describe()),
              HasSubstr("<x_dof>1</x_dof><y_dof>0</y_dof><z_dof>1</z_dof>"));
}

}  // namespace
}  // namespace lacuna
