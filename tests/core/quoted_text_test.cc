#include "core/quoted_text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/config.h"

namespace lacuna {
namespace {

TEST(QuotedText, IsReadBackAsYamlAndAsJson) {
  for (const std::string text : {"plain", "a \"b\" \\ c", "tab\t, line\nend", "\x1b[31m\x7f", "",
                                 "~", "größer", "#: {[*&!"}) {
    const std::string quoted = QuotedText(text);
    EXPECT_EQ(Config::Parse("{name: " + quoted + "}", "a.yaml").Text("name"), text) << quoted;
    EXPECT_EQ(nlohmann::json::parse(quoted), text) << quoted;
  }
}

}  // namespace
}  // namespace lacuna
