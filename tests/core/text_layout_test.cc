#include "core/text_layout.h"

#include <gtest/gtest.h>

namespace lacuna {
namespace {

TEST(TextLayout, CountsCharactersNotBytes) {
  EXPECT_EQ(DisplayWidth("σ ± 1"), 5u);
  EXPECT_EQ(PaddedRight("σ", 3), "σ  ");
  EXPECT_EQ(PaddedLeft("σ", 3), "  σ");
  EXPECT_EQ(PaddedLeft("longer", 3), " longer");
}

TEST(TextLayout, BreaksBetweenWordsAndKeepsTheMargins) {
  EXPECT_EQ(Wrapped("one two  three", "- ", "  ", 9), "- one two\n  three\n");
  EXPECT_EQ(Wrapped("indivisible", "  ", "  ", 5), "  indivisible\n");
  EXPECT_EQ(Wrapped("", "- ", "  "), "- \n");
}

}  // namespace
}  // namespace lacuna
