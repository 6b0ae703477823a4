#include "experiment/model_reader.h"

#include <gtest/gtest.h>

namespace lacuna {
namespace {

TEST(Profile, IsLinearBetweenItsPointsAndConstantBeyond) {
  const Config config =
      Config::Parse("profile: {times: [0 s, 500 ms, 2 s], values: [0, 1, 0.4]}", "a.yaml");
  const Profile profile = ReadProfile(config);
  EXPECT_EQ(profile.At(-1), 0);
  EXPECT_EQ(profile.At(0), 0);
  EXPECT_DOUBLE_EQ(profile.At(0.25), 0.5);
  EXPECT_DOUBLE_EQ(profile.At(0.5), 1);
  EXPECT_DOUBLE_EQ(profile.At(1.25), 0.7);
  EXPECT_DOUBLE_EQ(profile.At(9), 0.4);
}

TEST(Profile, IsOneWhereNoneIsGiven) {
  EXPECT_EQ(ReadProfile(Config::Parse("a: 1", "a.yaml")).At(0.3), 1);
}

TEST(Profile, RefusesTimesThatDoNotAscendAndUnevenLists) {
  for (const char* text :
       {"profile: {times: [0 s, 0 s], values: [0, 1]}", "profile: {times: [0 s, 1 s], values: [0]}",
        "profile: {times: [], values: []}"}) {
    EXPECT_THROW(ReadProfile(Config::Parse(text, "a.yaml")), InputError) << text;
  }
}

}  // namespace
}  // namespace lacuna
