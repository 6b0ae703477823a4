#include "effects/effect_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "effects/catalogue.h"
#include "fem/prescribed_force.h"

namespace lacuna {
namespace {

Eigen::VectorXd RandomParameters(const EffectCard& card, std::mt19937* random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  Eigen::VectorXd values(card.parameters.size());
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const ParameterCard& parameter = card.parameters[k];
    const double low = parameter.plausible_min, high = parameter.plausible_max;
    const double t = uniform(*random);
    values[k] =
        parameter.log_scale && low > 0 ? low * std::pow(high / low, t) : low + t * (high - low);
    if (t < 0.1 && std::isfinite(parameter.default_value)) values[k] = parameter.default_value;
  }
  return values;
}

std::shared_ptr<const Effect> ReadBack(const std::string& text, CatalogueEntry::Kind kind) {
  const Config config = Config::Parse("effect: " + text + "\n", "a.yaml");
  const Config effect = config.Child("effect");
  const auto made =
      kind == CatalogueEntry::Kind::kMaterial ? MakeMaterial(effect) : MakeEffect(effect);
  config.RefuseUnknownKeys();
  return made;
}

void ExpectRoundTrip(const CatalogueEntry& entry, const Eigen::VectorXd& values) {
  const auto effect = entry.make(values);
  const std::optional<std::string> text = FormatEffect(*effect);
  ASSERT_TRUE(text.has_value()) << entry.card->type;
  SCOPED_TRACE(*text);
  std::shared_ptr<const Effect> read;
  ASSERT_NO_THROW(read = ReadBack(*text, entry.kind));
  EXPECT_EQ(read->Card().type, entry.card->type);
  const Eigen::VectorXd expected = effect->Parameters(), got = read->Parameters();
  ASSERT_EQ(got.size(), expected.size());
  for (Eigen::Index k = 0; k < got.size(); ++k)
    EXPECT_EQ(std::bit_cast<uint64_t>(got[k]), std::bit_cast<uint64_t>(expected[k]))
        << entry.card->parameters[k].name;
}

TEST(EffectText, ReadsBackToTheSameBits) {
  std::mt19937 random(7);
  for (const CatalogueEntry& entry : Catalogue()) {
    if (entry.make == nullptr) continue;
    for (int trial = 0; trial < 50; ++trial) {
      Eigen::VectorXd values = RandomParameters(*entry.card, &random);
      const auto& cards = entry.card->parameters;
      const auto at = [&](const std::string& name) {
        return std::find_if(cards.begin(), cards.end(),
                            [&](const ParameterCard& card) { return card.name == name; }) -
               cards.begin();
      };
      // A force that ends before it starts is refused.
      if (const auto stop = at("stop"); stop < values.size()) values[stop] += values[at("start")];
      ExpectRoundTrip(entry, values);
    }
  }
}

TEST(EffectText, KeepsNumbersOfAnySize) {
  const CatalogueEntry& gravity = *FindEntry("gravity");
  constexpr double kSmallest = std::numeric_limits<double>::denorm_min();
  for (const double value :
       {0.0, -0.0, 0.1, 1.0 / 3, 1e-7, -1e22, 12345678.9, kSmallest, 1.7976931348623157e308})
    ExpectRoundTrip(gravity, Eigen::Vector3d(value, 1, -value));
}

TEST(EffectText, UsesTheSyntaxOfUsers) {
  EXPECT_EQ(FormatEffect(*MakeEffect("gravity", {{"acceleration_z", -9.80665}})),
            "{type: gravity, acceleration: [0 m/s^2, 0 m/s^2, -9.80665 m/s^2]}");
  EXPECT_EQ(
      FormatEffect(*MakeEffect("neo_hookean", {{"young_modulus", 1e5}, {"poisson_ratio", 0.35}})),
      "{law: neo_hookean, young_modulus: 100000 Pa, poisson_ratio: 0.35}");
}

TEST(EffectText, OmitsADirectionOfLengthZero) {
  const auto everywhere = MakeEffect("pressure", {{"pressure", 250}});
  EXPECT_EQ(FormatEffect(*everywhere),
            "{type: pressure, pressure: 250 Pa, point: [0 m, 0 m, 0 m]}");
  ExpectRoundTrip(*FindEntry("pressure"), everywhere->Parameters());
}

TEST(EffectText, ReadsAnExpressionLawBack) {
  const Config law = Config::Parse(
      "{type: expression, name: \"a \\\"pull\\\": #1\", per: area,\n"
      " force: [\"k * max(x - x0, 0)\", \"0\", \"-k * exp(-abs(z)/d)\"], amplitude: k,\n"
      " parameters: {d: {value: 5 mm, plausible: [1 mm, 50 mm], log_scale: true},\n"
      "              x0: {value: 3 cm, setting: true},\n"
      "              k: {value: 0.1 kPa, plausible: [-1 kPa, 2 kPa], min: -3 kPa,\n"
      "                  meaning: \"pull, in all\"}}}\n",
      "a.yaml");
  const auto made = MakeEffect(law);
  const auto moved = made->WithParameters(Eigen::Vector3d(1.0 / 3, 0.007, 0.03));
  EXPECT_EQ(made->Parameters(), Eigen::Vector3d(100, 0.005, 0.03));
  const std::optional<std::string> text = FormatEffect(*moved);
  ASSERT_TRUE(text.has_value());
  SCOPED_TRACE(*text);
  const auto read = ReadBack(*text, CatalogueEntry::Kind::kEffect);
  EXPECT_EQ(read->Parameters(), moved->Parameters());
  EXPECT_EQ(FormatEffect(*read), text);
  EXPECT_EQ(read->Card().title, made->Card().title);
  EXPECT_EQ(read->Card().equation, made->Card().equation);
  for (size_t k = 0; k < 3; ++k) {
    const ParameterCard &got = read->Card().parameters[k], &expected = made->Card().parameters[k];
    EXPECT_EQ(got.name, expected.name);
    EXPECT_EQ(got.meaning, expected.meaning);
    EXPECT_EQ(got.setting, expected.setting);
    EXPECT_EQ(got.log_scale, expected.log_scale);
    EXPECT_EQ(got.bounds.min, expected.bounds.min);
    EXPECT_EQ(got.bounds.open_min, expected.bounds.open_min);
    EXPECT_EQ(got.plausible_min, expected.plausible_min);
    EXPECT_EQ(got.plausible_max, expected.plausible_max);
  }
}

TEST(EffectText, IsNothingForValuesThatYamlCannotExpress) {
  EXPECT_EQ(FormatEffect(PrescribedForce(Eigen::VectorXd::Ones(1),
                                         [](double) { return Eigen::Vector3d(0, 0, 1); })),
            std::nullopt);
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(FormatEffect(*MakeEffect("gravity", {{"acceleration_z", kInfinite}})), std::nullopt);
}

// The unit of every dimension on a card is an SI unit that the reader understands.
TEST(EffectText, UnitsOfAllCardsAreSi) {
  for (const CatalogueEntry& entry : Catalogue()) {
    for (const ParameterCard& parameter : entry.card->parameters) {
      const Dimension& dimension = parameter.dimension;
      SCOPED_TRACE(entry.card->type + "." + parameter.name + " in " + dimension.unit);
      EXPECT_NO_THROW(EXPECT_EQ(ParseQuantity(std::string("1 ") + dimension.unit, dimension), 1));
      EXPECT_NO_THROW(ParseQuantity(dimension.example, dimension));
    }
  }
}

}  // namespace
}  // namespace lacuna
