#include "exchange/unique_names.h"

#include <gtest/gtest.h>

namespace lacuna {
namespace {

TEST(Identifier, HasLettersDigitsAndUnderscores) {
  EXPECT_EQ(Identifier("left clamp-2"), "left_clamp_2");
  EXPECT_EQ(Identifier("52 g"), "N_52_g");
  EXPECT_EQ(Identifier(""), "N_");
  EXPECT_EQ(Identifier("Ø"), "N___");  // two bytes
  EXPECT_EQ(Identifier(std::string(1000, 'a')).size(), 60u);
}

TEST(UniqueNames, GivesNoNameTwice) {
  UniqueNames names({"nodes"});
  EXPECT_EQ(names.Add("clamp"), "clamp");
  EXPECT_EQ(names.Add("clamp_2"), "clamp_2");
  EXPECT_EQ(names.Add("clamp"), "clamp_3");
  EXPECT_EQ(names.Add("nodes"), "nodes_2");
}

// A search that begins at 2 for each of the names takes minutes.
TEST(UniqueNames, AreFoundWhereAllAreEqual) {
  UniqueNames names;
  std::string last;
  for (int k = 0; k < 30000; ++k) last = names.Add("clamp");
  EXPECT_EQ(last, "clamp_30000");
}

}  // namespace
}  // namespace lacuna
