#include "effects/catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <variant>

namespace lacuna {
namespace {

std::string ErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Catalogue, HasEachNameOnce) {
  std::set<std::string> names;
  for (const CatalogueEntry& entry : Catalogue()) {
    EXPECT_TRUE(names.insert(entry.card->type).second) << entry.card->type;
    EXPECT_EQ(FindEntry(entry.card->type), &entry);
  }
  EXPECT_EQ(FindEntry("luminiferous_aether"), nullptr);
}

TEST(Catalogue, NamesOnlyLookAlikesThatExist) {
  for (const CatalogueEntry& entry : Catalogue()) {
    for (const std::string& other : entry.card->look_alikes) {
      EXPECT_NE(FindEntry(other), nullptr) << entry.card->type << " and " << other;
      EXPECT_NE(other, entry.card->type);
    }
  }
}

// To be a look-alike is a symmetric relation.
TEST(Catalogue, NamesLookAlikesBothWays) {
  for (const CatalogueEntry& entry : Catalogue()) {
    for (const std::string& other : LookAlikesOf(*entry.card)) {
      ASSERT_NE(FindEntry(other), nullptr) << other;
      EXPECT_THAT(LookAlikesOf(*FindEntry(other)->card), testing::Contains(entry.card->type))
          << "among those of " << other;
    }
  }
}

TEST(Catalogue, ExcludesOnlyEffectsThatExist) {
  for (const CatalogueEntry& entry : Catalogue())
    for (const std::string& other : entry.card->excludes)
      EXPECT_NE(FindEntry(other), nullptr) << entry.card->type << " and " << other;
}

TEST(Catalogue, LetsAModelHaveOneFreeStrain) {
  const auto card = [](const std::string& type) -> const EffectCard& {
    return *FindEntry(type)->card;
  };
  EXPECT_FALSE(MayStandBeside(card("swelling"), card("swelling_field")));
  EXPECT_FALSE(MayStandBeside(card("swelling_field"), card("swelling")));
  EXPECT_FALSE(MayStandBeside(card("swelling_field"), card("swelling_field")));
  EXPECT_TRUE(MayStandBeside(card("swelling"), card("inclusion")));
  EXPECT_TRUE(MayStandBeside(card("attached_mass"), card("attached_mass")));
  EXPECT_FALSE(MayStandBeside(card("gravity"), card("gravity")));
}

TEST(Catalogue, SaysOfEachEffectWhereItIsTried) {
  for (const CatalogueEntry& entry : Catalogue()) {
    const EffectCard& card = *entry.card;
    if (const auto* at_values = std::get_if<TriedAtValues>(&card.tried_at)) {
      EXPECT_GE(ParameterIndex(card, at_values->parameter), 0) << card.type;
      EXPECT_FALSE(at_values->values.empty()) << card.type;
    }
    if (const auto* at_times = std::get_if<TriedAtRelaxationTimes>(&card.tried_at)) {
      EXPECT_GE(ParameterIndex(card, at_times->parameter), 0) << card.type;
    }
    if (std::holds_alternative<TriedAtPlaces>(card.tried_at)) {
      EXPECT_GE(ParameterIndex(card, "centre_x"), 0) << card.type;
      EXPECT_GE(ParameterIndex(card, "radius"), 0) << card.type;
    }
    if (std::holds_alternative<TriedAsSupports>(card.tried_at)) {
      EXPECT_GE(ParameterIndex(card, "point_x"), 0) << card.type;
      EXPECT_GE(ParameterIndex(card, "side_x"), 0) << card.type;
    }
  }
}

// Two settings of one effect with the same draw would have the same random number.
TEST(Catalogue, GivesEachDrawnSettingOfAnEffectItsOwnDraw) {
  for (const CatalogueEntry& entry : Catalogue()) {
    std::set<int> draws;
    for (const ParameterCard& parameter : entry.card->parameters) {
      if (!parameter.trial.IsDrawn()) continue;
      EXPECT_TRUE(draws.insert(parameter.trial.draw).second)
          << entry.card->type << "." << parameter.name;
      EXPECT_GE(parameter.trial.min, parameter.plausible_min) << parameter.name;
      EXPECT_LE(parameter.trial.max, parameter.plausible_max) << parameter.name;
    }
  }
}

// Either from its parameter values or from YAML; `make` alone tells which.
TEST(Catalogue, MakesEachEffectInOneWay) {
  for (const CatalogueEntry& entry : Catalogue()) {
    const bool from_values = entry.make != nullptr;
    EXPECT_EQ(entry.read != nullptr, from_values) << entry.card->type;
    EXPECT_EQ(entry.make_from_yaml == nullptr, from_values) << entry.card->type;
    EXPECT_EQ(entry.format == nullptr, from_values) << entry.card->type;
  }
}

TEST(Catalogue, MakesAMaterialFromYaml) {
  const Config config = Config::Parse(
      "material: {law: neo_hookean, young_modulus: 0.1 MPa, poisson_ratio: 0.3}\n", "a.yaml");
  const auto material = MakeMaterial(config.Child("material"));
  EXPECT_EQ(material->Card().type, "neo_hookean");
  EXPECT_DOUBLE_EQ(material->Parameters()[0], 1e5);
  EXPECT_DOUBLE_EQ(material->Parameters()[1], 0.3);
  config.RefuseUnknownKeys();
}

TEST(Catalogue, MakesEffectsFromYaml) {
  const Config config = Config::Parse(
      "effects:\n"
      "  - {type: gravity, acceleration: [0, 0, -9.81 m/s^2]}\n"
      "  - {type: mass_damping, alpha: 0.5 1/s}\n",
      "a.yaml");
  const std::vector<Config> items = config.Items("effects");
  EXPECT_EQ(MakeEffect(items[0])->Parameters(), Eigen::Vector3d(0, 0, -9.81));
  EXPECT_DOUBLE_EQ(MakeEffect(items[1])->Parameters()[0], 0.5);
  config.RefuseUnknownKeys();
}

TEST(Catalogue, TakesTheModuliOfDampingFromTheMaterial) {
  const auto material =
      MakeEffect("corotational", {{"young_modulus", 7e4}, {"poisson_ratio", 0.42}});
  const Config config = Config::Parse("type: stiffness_damping\nbeta: 3 ms\n", "a.yaml");
  EXPECT_TRUE(
      MakeEffect(config, material.get())->Parameters().isApprox(Eigen::Vector3d(0.003, 7e4, 0.42)));
  EXPECT_THAT(ErrorOf([&] { MakeEffect(config); }), testing::HasSubstr("young_modulus"));
}

TEST(Catalogue, RefusesAnImpossiblePoissonRatio) {
  for (const std::string value : {"0.5", "0.6", "-1", "-3"}) {
    const Config config = Config::Parse(
        "law: linear\nyoung_modulus: 1 MPa\npoisson_ratio: " + value + "\n", "a.yaml");
    const std::string message = ErrorOf([&] { MakeMaterial(config); });
    EXPECT_THAT(message, testing::HasSubstr("a.yaml:3:")) << value;
    EXPECT_THAT(message, testing::HasSubstr("poisson_ratio")) << value;
  }
}

TEST(Catalogue, RefusesAnUnknownEffectAndALawAmongEffects) {
  const Config unknown = Config::Parse("type: gravty\n", "a.yaml");
  EXPECT_THAT(ErrorOf([&] { MakeEffect(unknown); }), testing::HasSubstr("gravity"));
  const Config law = Config::Parse("type: neo_hookean\n", "a.yaml");
  EXPECT_NE(ErrorOf([&] { MakeEffect(law); }), "");
}

}  // namespace
}  // namespace lacuna
