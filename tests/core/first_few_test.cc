#include "core/first_few.h"

#include <gtest/gtest.h>

namespace lacuna {
namespace {

TEST(FirstFew, ShowsFourAndTheNumberOfAll) {
  EXPECT_EQ(FirstFew(std::vector<int>{}), "");
  EXPECT_EQ(FirstFew(std::vector<int>{7}), "7");
  EXPECT_EQ(FirstFew(std::vector<std::string>{"a", "b", "c", "d"}), "a, b, c, d");
  EXPECT_EQ(FirstFew(std::vector<int>{1, 2, 3, 4, 5}), "1, 2, 3, 4, … (5 in all)");
}

}  // namespace
}  // namespace lacuna
