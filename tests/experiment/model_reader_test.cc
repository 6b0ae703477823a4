#include "experiment/model_reader.h"

#include <gmock/gmock.h>
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

std::vector<OwnLaw> Candidates(const std::string& item) {
  return ReadCandidates(Config::Parse("candidates: [" + item + "]", "a.yaml"), nullptr);
}

// A candidate has a name of its own, which only a law of the user's writes down.
TEST(Candidates, AreLawsOfTheUsersOwnOnly) {
  const std::vector<OwnLaw> laws = Candidates(
      "{type: expression, name: push, per: mass, force: [a, 0, 0], parameters: "
      "{a: {value: 1 m/s^2, plausible: [-9 m/s^2, 9 m/s^2]}}}");
  ASSERT_EQ(laws.size(), 1u);
  EXPECT_EQ(laws[0].name, "push");
  EXPECT_THAT([] { Candidates("{type: swelling_field, name: warm, strain: 0.1 %, field: \"Z\"}"); },
              testing::ThrowsMessage<InputError>(
                  testing::HasSubstr("a diagnosis cannot try swelling_field; candidates are")));
  EXPECT_THAT([] { Candidates("{type: gravity, name: pull}"); },
              testing::ThrowsMessage<InputError>(
                  testing::HasSubstr("a diagnosis tries gravity anyway; candidates are")));
}

}  // namespace
}  // namespace lacuna
