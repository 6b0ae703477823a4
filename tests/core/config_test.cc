#include "core/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kBeam[] = R"(schema_version: 1
material:
  law: neo_hookean
  young_modulus: 0.1 MPa
  poisson_ratio: 0.3
gravity: [0, 0, -9.81 m/s^2]
effects:
  - type: viscous_damping
    eta: 12 Pa s
)";

void ExpectInputError(const std::function<void()>& read,
                      const ::testing::Matcher<std::string>& message) {
  try {
    read();
    ADD_FAILURE() << "nothing was refused";
  } catch (const InputError& problem) {
    EXPECT_THAT(problem.what(), message);
  }
}

TEST(Config, ReadsValuesInSiUnits) {
  const Config beam = Config::Parse(kBeam, "beam.yaml");
  EXPECT_EQ(beam.Integer("schema_version", 1, 1), 1);
  const Config material = beam.Child("material");
  EXPECT_EQ(material.Choice<int>("law", {{"corotational", 1}, {"neo_hookean", 2}}), 2);
  EXPECT_DOUBLE_EQ(material.Quantity("young_modulus", kPressure, kPositive), 1e5);
  EXPECT_DOUBLE_EQ(material.Number("poisson_ratio", {-1, 0.5, true, true}), 0.3);
  EXPECT_DOUBLE_EQ(beam.Vector("gravity", kAcceleration)[2], -9.81);
  const auto effects = beam.Items("effects");
  ASSERT_EQ(effects.size(), 1u);
  EXPECT_EQ(effects[0].Text("type"), "viscous_damping");
  EXPECT_DOUBLE_EQ(effects[0].Quantity("eta", kViscosity, kNotNegative), 12);
  EXPECT_NO_THROW(beam.RefuseUnknownKeys());
}

TEST(Config, NamesFileLineColumnAndField) {
  const Config beam = Config::Parse("effects:\n  - type: viscous_damping\n    eta: 12 Pas\n",
                                    "experiments/bend.yaml");
  const Config effect = beam.Items("effects")[0];
  ExpectInputError([&] { effect.Quantity("eta", kViscosity, kNotNegative); },
                   "experiments/bend.yaml:3:10: effects[0].eta: got \"12 Pas\" (unknown unit "
                   "\"Pas\"); expected a viscosity, e.g. \"12 Pa s\"");
  ExpectInputError([&] { effect.Number("exponent", kAnyValue); },
                   "experiments/bend.yaml:2:5: effects[0].exponent: is missing; expected a plain "
                   "number, e.g. \"0.5\"");
}

TEST(Config, RefusesValuesOutOfBounds) {
  const Config config = Config::Parse("poisson_ratio: 0.7\nscale: -1\n", "a.yaml");
  ExpectInputError(
      [&] {
        config.Number("poisson_ratio", {-1, 0.5, true, true});
      },
      "a.yaml:1:16: poisson_ratio: got \"0.7\"; expected a plain number in (-1, 0.5)");
  ExpectInputError([&] { config.Number("scale", kPositive); },
                   "a.yaml:2:8: scale: got \"-1\"; expected a plain number > 0");
}

// In a flow mapping, a decimal comma begins another key.
TEST(Config, SaysThatTheDecimalSeparatorIsAPoint) {
  const auto refusal_of = [](const char* text) {
    const Config config = Config::Parse(text, "a.yaml");
    try {
      config.Child("material").Quantity("young_modulus", kPressure, kPositive);
    } catch (const InputError& problem) {
      return std::string(problem.what());
    }
    return std::string("nothing was refused");
  };
  EXPECT_THAT(refusal_of("material: {young_modulus: 0,2 MPa, law: neo_hookean}"),
              HasSubstr("a.yaml:1:27: material.young_modulus: got \"0\""));
  EXPECT_THAT(refusal_of("material: {young_modulus: 0,2 MPa, law: neo_hookean}"),
              EndsWith("; the decimal separator must be a point: \"0.2 MPa\""));
  EXPECT_THAT(refusal_of("material: {young_modulus: 1,05 MPa}"), EndsWith("\"1.05 MPa\""));
  for (const char* other : {"material: {young_modulus: 0, law: neo_hookean}",
                            "material: {young_modulus: 1, 5 mm}", "material: {young_modulus: 0, b}",
                            "material: {young_modulus: 0}", "material: {2 MPa, young_modulus: 0}"})
    EXPECT_THAT(refusal_of(other), AllOf(HasSubstr("got"), Not(HasSubstr("separator")))) << other;
}

// The part before the comma is a value that may stand there.
TEST(Config, FindsADecimalCommaAfterANumberThatIsAllowed) {
  const auto refusal_of = [](const char* text) {
    const Config config = Config::Parse(text, "a.yaml");
    try {
      config.Quantity("noise", kLength, kNotNegative, 0);
      config.Text("law", "linear");
      config.RefuseUnknownKeys();
    } catch (const InputError& problem) {
      return std::string(problem.what());
    }
    return std::string("nothing was refused");
  };
  EXPECT_EQ(refusal_of("{noise: 0,2 mm, law: linear}"),
            "a.yaml:1:11: 2 mm: unknown key; the decimal separator must be a point: \"0.2 mm\"");
  EXPECT_THAT(refusal_of("noise: 0,2 mm"), HasSubstr("a.yaml:1:8: noise: got \"0,2 mm\" (the "
                                                     "decimal separator must be a point"));
  for (const char* other : {"{noise: 0, 2x}", "{noise: 0, 2 mm: 1}", "{law: linear, 2 mm}"})
    EXPECT_THAT(refusal_of(other), AllOf(HasSubstr("unknown key"), Not(HasSubstr("separator"))))
        << other;
}

TEST(Config, SaysThatACommaSeparatesTheEntriesOfAVector) {
  const Config config = Config::Parse("a: [0,5 mm, 0, 1 mm]\nb: [1 mm, 2 mm]\n", "a.yaml");
  ExpectInputError([&] { config.Vector("a", kLength); },
                   AllOf(HasSubstr("got 4 entries; expected three"), HasSubstr("must be a point")));
  ExpectInputError([&] { config.Vector("b", kLength); },
                   AllOf(HasSubstr("got 2 entries"), Not(HasSubstr("point"))));
}

TEST(Config, RefusesUnknownKeysWithTheNearestKnownOne) {
  const Config beam = Config::Parse("material:\n  young_modulos: 1 MPa\n", "a.yaml");
  const Config material = beam.Child("material");
  material.Quantity("young_modulus", kPressure, kPositive, 1e5);
  material.Text("law", "corotational");
  ExpectInputError([&] { beam.RefuseUnknownKeys(); },
                   "a.yaml:2:3: material.young_modulos: unknown key; did you mean "
                   "\"young_modulus\"?");
}

TEST(Config, RefusesAKeyGivenTwice) {
  ExpectInputError([] { Config::Parse("a: 1\nb:\n  c: 1\n  c: 2\n", "a.yaml"); },
                   "a.yaml:4:3: c: is given twice");
}

TEST(Config, RefusesInvalidYamlAndOtherThanAMapping) {
  EXPECT_THROW(Config::Parse("a: [1, 2\n", "a.yaml"), InputError);
  EXPECT_THROW(Config::Parse("- 1\n", "a.yaml"), InputError);
  EXPECT_THROW(Config::Parse("", "a.yaml"), InputError);
  EXPECT_THROW(Config::Load("no/such/file.yaml"), InputError);
  ExpectInputError([] { Config::Parse("a: 1\n---\nb: 2\n", "a.yaml"); },
                   "a.yaml:3:1: a second YAML document starts here; expected one per file");
}

TEST(Config, InsertsPiecesWhoseEntriesTheFileOverrides) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "pieces");
  std::ofstream(folder / "pieces/camera.yaml")
      << "noise: 0.3 mm\nlens: {width: 2 mm}\nfile: a.txt\n";
  std::ofstream(folder / "pieces/four.yaml") << "use: camera.yaml\ncount: 4\n";
  std::ofstream(folder / "main.yaml")
      << "list:\n  - {use: pieces/four.yaml, noise: 1 mm}\n  - use: pieces/camera.yaml\n";
  const Config config = Config::Load(folder / "main.yaml");
  const std::vector<Config> items = config.Items("list");
  EXPECT_EQ(items[0].Quantity("noise", kLength, kPositive), 1e-3);
  EXPECT_EQ(items[0].Integer("count", 0, 9), 4);
  EXPECT_EQ(items[0].Child("lens").Quantity("width", kLength, kPositive), 2e-3);
  EXPECT_EQ(items[1].Quantity("noise", kLength, kPositive), 3e-4);
  EXPECT_EQ(items[1].Path("file"), folder / "pieces/a.txt");  // beside the piece
  ExpectInputError([&] { items[0].Child("lens").Integer("width", 0, 9); },
                   HasSubstr("pieces/camera.yaml:2:15"));
  ExpectInputError([&] { items[0].Integer("noise", 0, 9); },
                   HasSubstr("main.yaml:2:36: list[0].noise"));
  ExpectInputError([&] { config.RefuseUnknownKeys(); },
                   HasSubstr("camera.yaml"));  // items[1].lens, not read

  std::ofstream(folder / "pieces/camera.yaml") << "use: four.yaml\n";
  ExpectInputError([&] { Config::Load(folder / "main.yaml"); }, HasSubstr("would include itself"));
  std::filesystem::remove(folder / "pieces/camera.yaml");
  ExpectInputError([&] { Config::Load(folder / "main.yaml"); },
                   HasSubstr("pieces/four.yaml:1:6: list[0].use"));
}

TEST(Config, SuggestsTheNearestChoice) {
  const Config config = Config::Parse("law: neohookean\n", "a.yaml");
  const auto read = [&] { config.Choice<int>("law", {{"corotational", 1}, {"neo_hookean", 2}}); };
  ExpectInputError(read,
                   "a.yaml:1:6: law: got \"neohookean\"; expected one of: corotational, "
                   "neo_hookean; did you mean \"neo_hookean\"?");
}

TEST(Config, TakesPathsRelativeToTheFileAndExpandsTheEnvironment) {
  ASSERT_EQ(setenv("LACUNA_CONFIG_TEST", "data", 1), 0);
  const Config config = Config::Parse(
      "a: ../scan\nb: ${LACUNA_CONFIG_TEST}/x\nc: ${LACUNA_NOT_SET:-other}/y\nd: ${LACUNA_NOT_SET}",
      "study/a.yaml");
  EXPECT_EQ(config.Path("a"), "scan");
  EXPECT_EQ(config.Path("b"), "study/data/x");
  EXPECT_EQ(config.Path("c"), "study/other/y");
  EXPECT_THROW(config.Path("d"), InputError);
}

TEST(Config, RefusesANameThatWouldLeadOutOfItsFolder) {
  for (const char* name : {"..", "../../ESC", "a/b", ".hidden", "\"\"", "\"a\\nb\""}) {
    const Config config = Config::Parse(std::string("n: 1\nname: ") + name, "a.yaml");
    ExpectInputError([&] { config.Name("name"); },
                     HasSubstr("a.yaml:2:7: name: names a folder of results, so it must not"));
  }
  EXPECT_EQ(Config::Parse("name: silicone beam, 52 g", "a.yaml").Name("name"),
            "silicone beam, 52 g");
  ExpectInputError([] { Config::Parse("a: 1", "a.yaml").Name("name"); }, HasSubstr("is missing"));
}

TEST(Config, ResolvesToSiWithDefaults) {
  const Config beam = Config::Parse("material: {young_modulus: 0.1 MPa}\n", "a.yaml");
  beam.Child("material").Quantity("young_modulus", kPressure, kPositive);
  beam.Child("material").Number("poisson_ratio", kAnyValue, 0.3);
  beam.Items("effects");
  EXPECT_EQ(beam.Resolved(),
            nlohmann::json::parse(
                R"({"material": {"young_modulus": 1e5, "poisson_ratio": 0.3}, "effects": []})"));
}

TEST(Config, RefusesAnEntryOfTheWrongType) {
  const Config config = Config::Parse("a: {b: 1}\nv: [1 m, 2 m]\nn: 1.5\nf: maybe\n", "a.yaml");
  EXPECT_THROW(config.Text("a"), InputError);
  EXPECT_THROW(config.Items("a"), InputError);
  EXPECT_THROW(config.Vector("v", kLength), InputError);
  EXPECT_THROW(config.Integer("n", 0, 9), InputError);
  EXPECT_THROW(config.Flag("f", true), InputError);
  EXPECT_THROW(config.Child("n"), InputError);
}

TEST(Config, ListsItsKeysInOrderAndReadsQuantitiesOfAnyDimension) {
  const Config config = Config::Parse("z: 3 N/kg\na: 20 mm\nm: 4 mmm\n", "a.yaml");
  EXPECT_EQ(config.Keys(), (std::vector<std::string>{"z", "a", "m"}));
  EXPECT_TRUE(config.AnyQuantity("z").dimension.SameAs(kAcceleration));
  EXPECT_DOUBLE_EQ(config.AnyQuantity("a").value, 0.02);
  EXPECT_DOUBLE_EQ(config.Resolved()["a"], 0.02);
  ExpectInputError([&] { config.AnyQuantity("m"); },
                   "a.yaml:3:4: m: got \"4 mmm\" (unknown unit \"mmm\"); expected a number with "
                   "its unit, e.g. \"3 N/kg\"");
  ExpectInputError([&] { config.AnyQuantity("b"); }, HasSubstr("b: is missing"));
}

TEST(Config, ReportsThePositionOfAListItem) {
  const Config config = Config::Parse("force: [\"a\",\n  \"b\"]\ntext: c\n", "a.yaml");
  ExpectInputError([&] { config.FailAtItem("force", 1, "no"); }, "a.yaml:2:3: force[1]: no");
  ExpectInputError([&] { config.FailAtItem("force", 2, "no"); }, "a.yaml:1:8: force: no");
  ExpectInputError([&] { config.FailAtItem("text", 0, "no"); }, "a.yaml:3:7: text: no");

  const Config lists = Config::Parse("names: [a, {b: 1}]\n", "a.yaml");
  ExpectInputError([&] { lists.Texts("names"); },
                   "a.yaml:1:12: names[1]: got a mapping; expected a string");
}

}  // namespace
}  // namespace lacuna
