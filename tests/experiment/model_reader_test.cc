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

TEST(AuxeticWarning, NamesTheFirstNegativePoissonRatio) {
  const auto warning = [](const std::string& ratio, const std::string& effects) {
    return AuxeticWarning(ReadEffects(
        Config::Parse("material: {law: linear, young_modulus: 0.1 MPa, poisson_ratio: " + ratio +
                          "}\neffects: [" + effects + "]",
                      "a.yaml")));
  };
  const std::string branch =
      "{type: viscoelastic_branch, modulus: 10 kPa, relaxation_time: 1 s, poisson_ratio: -0.2}";
  EXPECT_THAT(warning("-0.3", ""), testing::HasSubstr("linear.poisson_ratio is -0.3: an auxetic"));
  EXPECT_THAT(warning("0.3", branch),
              testing::HasSubstr("viscoelastic_branch.poisson_ratio is -0.2: an auxetic"));
  EXPECT_EQ(warning("0", ""), "");
  EXPECT_THROW(warning("0.5", ""), InputError);
}

Config WithEffects(const std::string& effects) {
  return Config::Parse(
      "material: {law: linear, young_modulus: 0.1 MPa, poisson_ratio: 0.3}\neffects:\n" + effects,
      "a.yaml");
}

// What is said of a list of effects that cannot be read.
std::string Refusal(const std::string& effects) {
  try {
    ReadEffects(WithEffects(effects));
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

const std::string kMass = "  - {type: attached_mass, mass: 12 g, centre: [1 cm, 0, 0]}\n";
const std::string kSideways = "  - {type: gravity, acceleration: [9.81 m/s^2, 0, 0]}\n";

TEST(Effects, LetAddedMassesFallAsTheBodyDoes) {
  const EffectList effects = ReadEffects(WithEffects(kMass + kSideways));
  ASSERT_EQ(effects.size(), 3u);
  EXPECT_EQ(effects[1]->Parameters().tail<3>(), Eigen::Vector3d(9.81, 0, 0));
  EXPECT_THAT(Refusal("  - {type: density_gradient, gradient: 5 kg/m^4, gravity: [0, 0, -9.81 "
                      "m/s^2]}\n" +
                      kSideways),
              testing::HasSubstr("effects[0].gravity: the gravity of the model is [9.81, 0, 0]"));
  EXPECT_THAT(Refusal(kMass), testing::HasSubstr("effects[0].gravity: must be given in a model"));
}

// A recording may have gravity and masses of its own.
TEST(Effects, OfARecordingHaveTheGravityOfItsModel) {
  const EffectList with_gravity = ReadEffects(WithEffects(kSideways));
  EXPECT_EQ(ReadModelGravity(WithEffects(kMass), with_gravity), Eigen::Vector3d(9.81, 0, 0));
  const auto without = [](const std::string& gravity) {
    return ReadEffects(
        WithEffects("  - {type: attached_mass, mass: 12 g, centre: [1 cm, 0, 0], "
                    "gravity: " +
                    gravity + "}\n"));
  };
  const EffectList weightless = without("[0, 0, 0]"), falling = without("[0, 0, -9.81 m/s^2]");
  EXPECT_EQ(ReadModelGravity(WithEffects("  []"), weightless), std::nullopt);
  EXPECT_EQ(ReadModelGravity(WithEffects(kSideways), weightless), Eigen::Vector3d(9.81, 0, 0));
  // The same but for the rounding of another unit.
  EXPECT_NO_THROW(ReadModelGravity(
      WithEffects("  - {type: gravity, acceleration: [0, 0, -981.0000000001 cm/s^2]}\n"), falling));
  EXPECT_THAT([&] { ReadModelGravity(WithEffects(kSideways), falling); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr(
                  "effects[0].type: differs from the gravity of attached_mass among the "
                  "experiment's effects; list both there")));
}

TEST(Effects, CannotIncludeTwoFreeStrains) {
  const std::string field = "  - {type: swelling_field, strain: 10 %, field: \"1\"}\n";
  EXPECT_THAT(Refusal(field + "  - {type: swelling, strain: 10 %}\n"),
              testing::HasSubstr("effects[1].type: swelling cannot be combined with "
                                 "swelling_field"));
  EXPECT_THAT(Refusal(field + field), testing::HasSubstr("swelling_field is listed twice"));
  EXPECT_EQ(Refusal(field), "nothing was refused");
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
