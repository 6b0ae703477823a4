// The .feb file. FEBio is not at hand: the tests check the text.
#include "exchange/feb_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>

#include "exchange/cantilever.h"

namespace lacuna {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> MissingParts(const PortableModel& model) {
  std::vector<std::string> names;
  for (const Counterpart& part : Missing(FebCounterparts(model))) names.push_back(part.part);
  return names;
}

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
  EXPECT_THAT(MissingParts(model), ElementsAre("mass_damping", "viscoelastic_branch"));
  // g = m/E; the first step lasts a thousand relaxation times.
  EXPECT_THAT(FebText(model), HasSubstr("<g1>0.5</g1><t1>0.04</t1>\n<elastic type=\"isotropic"));
  EXPECT_THAT(FebText(model), HasSubstr("<pt>40,1</pt>"));
}

TEST(FebWriter, ClosesEveryElementOfTheXml) {
  PortableModel model = Bar().Describe();
  model.regions[0].name = "a--b <&>";
  model.run = "x -- y";
  const std::string text = FebText(model);
  std::vector<std::string> open;
  for (size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
    if (text.compare(at, 4, "<!--") == 0) {
      at = text.find("--", at + 4);
      ASSERT_EQ(text[at + 2], '>') << "two hyphens inside a comment";
      continue;
    }
    if (text[at + 1] == '?') continue;
    const size_t end = text.find('>', at);
    const std::string name = text.substr(at + 1, text.find_first_of(" >/", at + 2) - at - 1);
    if (text[at + 1] == '/') {
      ASSERT_FALSE(open.empty());
      EXPECT_EQ(text.substr(at + 2, end - at - 2), open.back());
      open.pop_back();
    } else if (text[end - 1] != '/') {
      open.push_back(name);
    }
  }
  EXPECT_TRUE(open.empty());
}

TEST(FebWriter, HoldsPartsAlongTheirAxesOnly) {
  Cantilever bar("st_venant_kirchhoff", {2, 1, 1}, 1);
  bar.model.grips[0].axes = AxisSet::Of(0) | AxisSet::Of(2);
  EXPECT_THAT(FebText(bar.Describe()),
              testing::HasSubstr("<x_dof>1</x_dof><y_dof>0</y_dof><z_dof>1</z_dof>"));
}

}  // namespace
}  // namespace lacuna
