#include "sweep/sweep_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "core/error.h"
#include "reconstruction/reconstruction_study.h"
#include "small_sweep.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

constexpr char kGrid[] =
    "vary:\n"
    "  mesh.max_volume: [100 mm^3, 200 mm^3]\n"
    "  material.young_modulus: [1 kPa, 2 kPa]\n";

std::vector<std::string> NamesOf(const SweepPlan& plan) {
  std::vector<std::string> names;
  for (const SweepCase& entry : plan.cases) names.push_back(entry.name);
  return names;
}

// A folder, if it exists, and everything in it.
std::set<std::filesystem::path> ContentOf(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder)) return {};
  std::set<std::filesystem::path> content = {folder};
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    content.insert(entry.path());
  return content;
}

void ExpectRefused(const TemporaryFolder& folder, const std::string& lines,
                   const ::testing::Matcher<const std::string&>& message) {
  const auto before = ContentOf(folder / "cases");
  EXPECT_THAT([&] { PlanSmallSweep(folder.Path(), lines); }, ThrowsMessage<InputError>(message));
  EXPECT_EQ(ContentOf(folder / "cases"), before) << "something was written";
}

TEST(SweepPlan, ContainsTheGridWithSelfContainedExperiments) {
  const TemporaryFolder folder;
  const SweepPlan plan = PlanSmallSweep(folder.Path(), kGrid);
  ASSERT_EQ(plan.cases.size(), 4u);
  EXPECT_EQ(plan.added, 4);
  EXPECT_EQ(Describe(plan.cases[1]),
            "bend.yaml with material.young_modulus = 2 kPa, mesh.max_volume = 100 mm^3");
  EXPECT_THAT(plan.cases[3].name, StartsWith("0004-"));
  // A planned case does not need the original file, and its paths lead to the data.
  std::filesystem::remove(folder / "bend.yaml");
  const auto study =
      ReadReconstruction(Config::Load(folder / "cases" / plan.cases[1].name / "experiment.yaml"));
  EXPECT_DOUBLE_EQ(study.mesh.tets.max_volume, 1e-7);
  EXPECT_EQ(study.configuration.at("material").at("young_modulus"), 2000);
  EXPECT_THAT(study.output.string(), EndsWith(plan.cases[1].name + "/run"));
  EXPECT_THAT(FileContent(folder / "cases/cases.csv"),
              HasSubstr("number,case,experiment,material.young_modulus,mesh.max_volume\n"));
}

TEST(SweepPlan, KeepsNamesWhenTheSweepGrows) {
  const TemporaryFolder folder;
  const std::vector<std::string> before = NamesOf(PlanSmallSweep(folder.Path(), kGrid));
  EXPECT_EQ(NamesOf(PlanSmallSweep(folder.Path(), kGrid)), before);
  // A new value in the middle, another order, and an additional case.
  const SweepPlan grown = PlanSmallSweep(folder.Path(),
                                         "vary:\n"
                                         "  material.young_modulus: [1 kPa, 3 kPa, 2 kPa]\n"
                                         "  mesh.max_volume: [200 mm^3, 100 mm^3]\n"
                                         "cases: [{forces.model: none}]\n");
  EXPECT_EQ(grown.added, 3);
  std::vector<std::string> names = NamesOf(grown);
  ASSERT_EQ(names.size(), 7u);
  names.resize(4);
  EXPECT_EQ(names, before);
  EXPECT_TRUE(grown.absent.empty());
  const SweepPlan shrunk = PlanSmallSweep(folder.Path(), "cases: [{forces.model: none}]\n");
  EXPECT_EQ(shrunk.added, 0);
  EXPECT_EQ(shrunk.cases.size(), 7u);
  EXPECT_EQ(shrunk.absent.size(), 6u);
}

// A carriage return, too, would end the comment at the head of the case's files.
TEST(SweepPlan, ACaseIsDescribedOnOneLine) {
  SweepCase entry;
  entry.experiment = "bend.yaml";
  entry.changes = {{"name", "a\rb\r\nc"}, {"mesh.order", "1"}};
  EXPECT_EQ(Describe(entry), "bend.yaml with name = a b  c, mesh.order = 1");
}

TEST(SweepPlan, RefusesACasePlannedFromOtherContents) {
  const TemporaryFolder folder;
  const std::filesystem::path file = WriteSmallSweep(folder.Path(), kGrid);
  PlanSweep(Config::Load(file), folder / "cases");
  std::ofstream(folder / "bend.yaml", std::ios::app) << "density: 900 kg/m^3\n";
  EXPECT_THAT([&] { PlanSweep(Config::Load(file), folder / "cases"); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("0001-"), HasSubstr("planned before"))));
}

TEST(SweepPlan, ReportsErrorsAtTheValueInTheSweepFile) {
  const TemporaryFolder folder;
  ExpectRefused(folder, "vary:\n  mesh.max_volume: [1 mm^3, 150]\n",
                AllOf(HasSubstr("sweep.yaml:6:"), HasSubstr("vary.mesh.max_volume[1]: got \"150\""),
                      HasSubstr("a volume")));
  ExpectRefused(
      folder, "vary:\n  mesh.max_volum: [1 mm^3]\n",
      AllOf(HasSubstr("sweep.yaml:6:"), HasSubstr("unknown key"), HasSubstr("max_volume")));
  ExpectRefused(folder, "cases:\n  - {}\n  - {filtre.voxel: 1 mm}\n",
                AllOf(HasSubstr("sweep.yaml:7:"), HasSubstr("cases[1].filtre.voxel")));
  ExpectRefused(folder, "cases: [{name.x: 1}]\n",
                HasSubstr("cases[0].name.x: name is not a mapping"));
  ExpectRefused(folder, "cases: [{output: x}]\n", HasSubstr("cannot be set"));
  ExpectRefused(folder, "cases: [{mesh.order: 1}, {mesh.order: 1}]\n",
                HasSubstr("cases[1]: repeats another case"));
  ExpectRefused(folder, "vary: {mesh.order: []}\n", HasSubstr("has no values"));
  ExpectRefused(folder, "varry: {mesh.order: [1]}\n", HasSubstr("did you mean \"vary\"?"));
}

TEST(SweepPlan, AListOrMappingIsWrittenInQuotes) {
  const TemporaryFolder folder;
  const SweepPlan plan =
      PlanSmallSweep(folder.Path(),
                     "vary:\n"
                     "  effects: ['[]', '[{type: gravity, acceleration: [0, 0, -9.81 m/s^2]}]']\n"
                     "  forces: ['~', '{model: none}']\n");
  ASSERT_EQ(plan.cases.size(), 4u);
  const auto study =
      ReadReconstruction(Config::Load(folder / "cases" / plan.cases[3].name / "experiment.yaml"));
  ASSERT_EQ(study.effects.size(), 2u);
  EXPECT_EQ(study.effects[1]->Card().type, "gravity");
  EXPECT_EQ(study.follow.forces.kind, ForceSettings::Kind::kNone);
}

TEST(SweepPlan, RefusesAFolderWithOtherContents) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "cases");
  std::ofstream(folder / "cases/thesis.tex") << "mine";
  ExpectRefused(folder, kGrid, HasSubstr("is neither empty nor a sweep"));
}

TEST(SweepPlan, ReadsTheBundledSearchesAndTable) {
  const TemporaryFolder folder;
  const std::string table = std::string(LACUNA_SOURCE_DIR) + "/experiments/table1";
  const auto plan = [&](const std::string& name, const std::string& lines) {
    std::ofstream(folder / (name + ".yaml")) << "schema_version: 1\nname: s\n" << lines;
    return PlanSweep(Config::Load(folder / (name + ".yaml")), folder / name);
  };
  const SweepPlan searches =
      plan("search", "command: outer_search\nexperiments: [" + table + "/all.yaml, " + table +
                         "/material.yaml]\nvary: {seed: [1, 2]}\n");
  EXPECT_EQ(searches.cases.size(), 4u);
  const std::string table_lines = "command: table1\nseeds: 2\nexperiments: " + table +
                                  "\nvary: {search.measure: [per_point, sum]}\n";
  const SweepPlan tables = plan("table", table_lines);
  ASSERT_EQ(tables.cases.size(), 2u);
  EXPECT_EQ(tables.cases[0].settings.seeds, 2);
  EXPECT_TRUE(std::filesystem::exists(folder / "table" / tables.cases[1].name /
                                      "experiments/geometry.yaml"));
  EXPECT_EQ(plan("table", table_lines).added, 0);
  // As if the folder of the table had lost a file since.
  const std::filesystem::path planned = folder / "table" / tables.cases[1].name / "experiments";
  std::filesystem::copy_file(planned / "geometry.yaml", planned / "lost.yaml");
  EXPECT_THAT(
      [&] { plan("table", table_lines); },
      ThrowsMessage<InputError>(AllOf(HasSubstr("no longer contains"), HasSubstr("lost.yaml"))));
  EXPECT_THAT(
      [&] {
        plan("other", "command: outer_search\nexperiments: " + table +
                          "/all.yaml\nvary: {search.method: [cobila]}\n");
      },
      ThrowsMessage<InputError>(
          AllOf(HasSubstr("other.yaml:5:"), HasSubstr("did you mean \"cobyla\"?"))));
}

}  // namespace
}  // namespace lacuna
