#include "core/changed_yaml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class ChangedYamlTest : public ::testing::Test {
 protected:
  ChangedYamlTest() {
    for (const char* name : {"base/pieces", "data", "elsewhere"})
      std::filesystem::create_directories(folder_ / name);
    std::ofstream(folder_ / "base/pieces/bar.yaml") << "scan: ../../data/scan.csv\nsize: 3 mm\n";
    std::ofstream(folder_ / "base/e.yaml") << "bar: {use: pieces/bar.yaml}\n"
                                              "scan: ../data/other.csv\n"
                                              "effects: [{type: drag, eta: \"1\"}]\n"
                                              "twice: &a {x: 1}\n"
                                              "again: *a\n";
  }
  Config Changed(const std::vector<YamlChange>& changes) const {
    const std::string text =
        ChangedYaml(folder_ / "base/e.yaml", changes, {"scan"}, folder_ / "elsewhere/deep");
    return Config::Parse(text, folder_ / "elsewhere/deep/e.yaml");
  }

  TemporaryFolder folder_;
};

TEST_F(ChangedYamlTest, InsertsIncludedPiecesAndRewritesTheirPaths) {
  const Config whole = Changed({});
  EXPECT_EQ(whole.Child("bar").Text("size"), "3 mm");
  EXPECT_EQ(whole.Child("bar").Text("scan"), "../../data/scan.csv");
  EXPECT_EQ(whole.Path("scan"), folder_ / "data/other.csv");
}

TEST_F(ChangedYamlTest, ReplacesAddsAndRemovesEntries) {
  const Config changed = Changed({{"effects[0].eta", "2", "s.yaml"},
                                  {"bar.size", "~", "s.yaml"},
                                  {"new.of.all", "[1, 2]", "s.yaml"},
                                  {"scan", "mine.csv", folder_ / "base/pieces/s.yaml"}});
  EXPECT_EQ(changed.Items("effects")[0].Text("eta"), "2");
  EXPECT_FALSE(changed.Child("bar").Has("size"));
  EXPECT_EQ(changed.Child("new").Child("of").Integers("all", 0), (std::vector<int>{1, 2}));
  EXPECT_EQ(changed.Path("scan"), folder_ / "base/pieces/mine.csv");
}

TEST_F(ChangedYamlTest, AddsItemsToLists) {
  const Config changed =
      Changed({{"effects[+]", "{type: gravity, scan: mine.csv}", folder_ / "data/s.yaml"},
               {"effects[1].z", "3", "s.yaml"}});
  const std::vector<Config> effects = changed.Items("effects");
  ASSERT_EQ(effects.size(), 2u);
  EXPECT_EQ(effects[0].Text("type"), "drag");
  EXPECT_EQ(effects[1].Text("type"), "gravity");
  EXPECT_EQ(effects[1].Text("z"), "3");
  EXPECT_EQ(effects[1].Path("scan"), folder_ / "data/mine.csv");
}

TEST_F(ChangedYamlTest, RefusesFieldsThatCannotExist) {
  const auto refuses = [this](const std::string& field, const char* message) {
    EXPECT_THAT(
        [&] {
          Changed({{field, "1", "s.yaml"}});
        },
        ThrowsMessage<InputError>(HasSubstr(field + ": " + message)));
  };
  refuses("effects[1].eta", "effects has no item [1]");
  refuses("effects.eta", "effects is not a mapping");
  refuses("bar[+]", "bar is not a list");
  refuses("scan.x", "scan is not a mapping");
  refuses("again.x", "again is shared by several places");
  refuses("bar..size", "is not a field name");
  refuses("bar.", "is not a field name");
  EXPECT_THAT(
      [&] {
        Changed({{"bar", "[1", "s.yaml"}});
      },
      ThrowsMessage<InputError>(HasSubstr("bar: \"[1\" is not valid YAML")));
}

}  // namespace
}  // namespace lacuna
