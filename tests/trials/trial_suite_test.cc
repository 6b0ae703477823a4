#include "trials/trial_suite.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "core/error.h"
#include "effects/catalogue.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string RefusalOfSuite(const std::string& rest) {
  try {
    ReadTrialSuite(Config::Parse("schema_version: 1\nname: x\nseed: 1\n" + rest, "suite.yaml"));
  } catch (const InputError& problem) {
    return problem.what();
  }
  return "nothing was refused";
}

TEST(TrialSuite, RefusesEffectsThatCannotBeHidden) {
  EXPECT_THAT(RefusalOfSuite("effects: [drag, levity]\n"),
              AllOf(HasSubstr("suite.yaml:4:17: effects[1]"),
                    HasSubstr("no effect is called \"levity\"; expected one of: "),
                    HasSubstr("mass_damping"), Not(HasSubstr("expression"))));
  EXPECT_THAT(RefusalOfSuite("removed: [expression]\n"), HasSubstr("removed[0]"));
  EXPECT_THAT(RefusalOfSuite("effects: [swelling_field]\n"), HasSubstr("numbers alone"));
  EXPECT_THAT(RefusalOfSuite("effects: [neo_hookean]\n"), HasSubstr("law of every model"));
  EXPECT_THAT(RefusalOfSuite("effects: [drag, gravity, drag]\n"), HasSubstr("listed twice"));
}

TEST(TrialSuite, HidesEveryOtherEffectOfTheCatalogue) {
  const TrialCase trial = DrawCase("any", TrialGroup::kOneEffect, 5, 1, false, "");
  int possible = 0;
  for (const CatalogueEntry& entry : Catalogue()) {
    const std::string& type = entry.card->type;
    if (RefusalOfSuite("effects: [" + type + "]\n") != "nothing was refused") continue;
    EXPECT_EQ(MakeHidden(DrawHidden(type, trial, 7))->Card().type, type);
    ++possible;
  }
  // All but the model's own law and the two that contain formulas.
  EXPECT_EQ(possible, static_cast<int>(Catalogue().size()) - 3);
}

TEST(TrialSuite, RefusesNumbersThatMakeNoCases) {
  EXPECT_THAT(RefusalOfSuite("recordings: [1, 3]\n"),
              AllOf(HasSubstr("suite.yaml:4:17: recordings[1]"), HasSubstr("1 or 2")));
  EXPECT_THAT(RefusalOfSuite("effects: [drag]\npairs: 1\n"),
              AllOf(HasSubstr("suite.yaml:5:"), HasSubstr("pairs"), HasSubstr("at least two")));
  EXPECT_THAT(RefusalOfSuite("effects: [drag, gravity]\npairs: 1\n"),
              HasSubstr("nothing was refused"));
}

TEST(TrialSuite, AbandonsACaseWhoseTruthCannotBeSimulated) {
  const TemporaryFolder folder;
  TrialCase trial = DrawCase("dust", TrialGroup::kControl, 5, 1, false, "");
  trial.true_element_volume = 1e-27;  // m³: too many elements for any mesh
  EXPECT_FALSE(MakeCase(trial, folder.Path()));
  EXPECT_THAT(FileContent(folder / "dust/skipped.txt"), HasSubstr("tetrahedra"));
}

}  // namespace
}  // namespace lacuna
