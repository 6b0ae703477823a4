// A report's document of several runs, which are compared.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "report/small_report.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// The same runs, of which the second is shown together with the first.
TEST(ReportDocument, ARunIsComparedWithTheOneThatItWasMadeFrom) {
  const TemporaryFolder folder;
  WriteFit(folder / "bar", {});
  WriteFit(folder / "bar+drag", {.name = "bar+drag", .effects = {"drag"}});
  const json document = ReportDocument({folder / "bar", folder / "bar+drag"});
  EXPECT_EQ(document.at("differences"),
            json({{{"key", "effects"}, {"values", {"[]", ""}}},
                  {{"key", "effects[0].type"}, {"values", {"", "drag"}}},
                  {{"key", "name"}, {"values", {"bar", "bar+drag"}}}}));
  WriteFit(folder / "bar+drag", {.name = "bar+drag", .held_out_frames = 12, .effects = {"drag"}});
  EXPECT_THAT(WhyRefused({folder / "bar", folder / "bar+drag"}),
              HasSubstr("the errors of bar and bar+drag cannot be compared"));
}

TEST(ReportDocument, TwoRunsAreComparedByTheirConfigurations) {
  const TemporaryFolder folder;
  WriteFit(folder / "soft", {.name = "soft", .young_modulus = 1e5});
  WriteFit(folder / "stiff", {.name = "stiff", .young_modulus = 2e5});
  const json document = ReportDocument({folder / "soft", folder / "stiff"});
  EXPECT_EQ(document.at("title"), "soft, stiff");
  EXPECT_EQ(document.at("runs").size(), 2u);
  EXPECT_EQ(document.at("differences"),
            json({{{"key", "material.young_modulus"}, {"values", {"100000", "200000"}}},
                  {{"key", "name"}, {"values", {"soft", "stiff"}}}}));
  EXPECT_THAT(document.at("sentences").at(0).get<std::string>(), HasSubstr("soft: The model"));
}

TEST(ReportDocument, RefusesErrorsThatCannotBeCompared) {
  const TemporaryFolder folder;
  WriteFit(folder / "a", {.name = "a"});
  WriteFit(folder / "longer", {.name = "longer", .held_out_frames = 12});
  WriteFit(folder / "other", {.name = "other", .content = "another recording"});
  EXPECT_THAT(WhyRefused({folder / "a", folder / "longer"}),
              HasSubstr("the errors of a and longer cannot be compared: a with 30 fitted and 10 "
                        "held-out frames of markers, and a with 30 fitted and 12"));
  EXPECT_THAT(WhyRefused({folder / "a", folder / "other"}),
              HasSubstr("the content of a/markers.csv is not the same"));
}

}  // namespace
}  // namespace lacuna
