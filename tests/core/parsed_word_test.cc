#include "core/parsed_word.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace lacuna {
namespace {

TEST(ParseWord, ReadsANumberThatIsTheWholeWord) {
  EXPECT_EQ(ParseWord<int>("-7"), -7);
  EXPECT_EQ(ParseWord<double>("1.5e3"), 1500);
  for (const char* word : {"", " 7", "7 ", "7x", "+7", "7.5", "99999999999"})
    EXPECT_FALSE(ParseWord<int>(word)) << word;
  EXPECT_FALSE(ParseWord<uint32_t>("-1"));
  EXPECT_FALSE(ParseWord<double>("1e999"));
}

TEST(ParseSignedWord, AllowsOneSign) {
  EXPECT_EQ(ParseSignedWord<int>("+7"), 7);
  EXPECT_EQ(ParseSignedWord<double>("-7.5"), -7.5);
  for (const char* word : {"+-7", "++7", "-+7", "+"})
    EXPECT_FALSE(ParseSignedWord<int>(word)) << word;
}

}  // namespace
}  // namespace lacuna
