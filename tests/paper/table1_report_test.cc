// Table 1 of made-up searches: its numbers, and which claims of the paper hold by them.
#include "paper/table1_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "paper/made_up_table1.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct MadeUpTable1 {
  Table1Study study;
  Table1Result result;
};

// Two seeds of three searches. The mesh noise is 1 %.
MadeUpTable1 MakeTable1() {
  MadeUpTable1 table;
  table.study.true_young_modulus = 1e6;
  table.study.true_poisson_ratio = 0.3;
  table.study.configurations = {MadeUpConfiguration("geometry", false),
                                MadeUpConfiguration("material", true),
                                MadeUpConfiguration("all", true)};
  table.study.configurations[0].paper_drop = 0.22;
  table.study.configurations[1].paper_drop = 0.5;
  table.study.configurations[2].paper_drop = 0.3;
  table.result.seeds = {
      {3, {MadeUpSearch(3e-3, 5e5), MadeUpSearch(2.4e-3, 8e5), MadeUpSearch(2e-3, 2e6)}},
      {4, {MadeUpSearch(3.2e-3, 5e5), MadeUpSearch(3.95e-3, 1e6), MadeUpSearch(3.3e-3, 4e6)}}};
  // The sum of the geometry falls by 10 %, from 1.2 m.
  for (Table1Seed& seed : table.result.seeds)
    seed.searches[0].found.evaluations[1].residual_sum = 1.08;
  ObjectiveEvaluation failed;
  table.result.turned = {MadeUpEvaluation(0.99e-3), failed, MadeUpEvaluation(1e-3),
                         MadeUpEvaluation(1.01e-3)};
  return table;
}

TEST(Table1Report, ARangeIsTheMedianAndTheExtremesOfWhatWasMeasured) {
  const SeedRange odd = RangeOf({3, kNotMeasured, 1, 2});
  EXPECT_EQ(odd.median, 2);
  EXPECT_EQ(odd.least, 1);
  EXPECT_EQ(odd.largest, 3);
  EXPECT_EQ(RangeOf({4, 1}).median, 2.5);
  EXPECT_TRUE(std::isnan(RangeOf({}).median));
}

TEST(Table1Report, DropsAreRelativeToTheLargestValueTheStartAndTheTruth) {
  MadeUpTable1 table = MakeTable1();
  // A third evaluation that is larger than the start.
  ParameterSearchResult& found = table.result.seeds[0].searches[2].found;
  found.evaluations.push_back(MadeUpEvaluation(8e-3));
  found.parameters.push_back(found.parameters[0]);
  table.result.seeds[0].searches[2].worst = 2;
  const Table1Summary summary = Summarise(table.study, table.result);
  ASSERT_EQ(summary.rows.size(), 3u);
  const Table1Row& geometry = summary.rows[0];
  EXPECT_EQ(geometry.seeds, 2);
  EXPECT_NEAR(geometry.drop_from_max.median, 0.225, 1e-12);  // 25 % and 20 %
  EXPECT_NEAR(geometry.sum_drop.median, 0.1, 1e-12);
  EXPECT_NEAR(geometry.below_truth.largest, 1 - 3 / 3.5, 1e-12);
  const Table1Row& all = summary.rows[2];
  EXPECT_NEAR(all.drop_from_max.largest, 0.75, 1e-12);
  EXPECT_NEAR(all.sum_drop.largest, 0.75, 1e-12);
  EXPECT_NEAR(all.drop_from_start.largest, 0.5, 1e-12);
  EXPECT_NEAR(all.drop_from_start.least, 1 - 3.3 / 4, 1e-12);
  EXPECT_EQ(all.young_modulus.median, 3e6);
  EXPECT_NEAR(summary.mesh_noise, 0.01, 1e-12);
  EXPECT_EQ(summary.turns, 3);
}

TEST(Table1Report, ClaimsHoldOrNotByTheNumbers) {
  const MadeUpTable1 table = MakeTable1();
  const std::string text = Table1ClaimsText(table.study, table.result);
  const std::string improves =
      " improves on its start in every seed, by more than two deviations of the mesh noise: ";
  EXPECT_THAT(text, HasSubstr("- geometry" + improves + "holds\n"));
  // 1.25 % with the second seed.
  EXPECT_THAT(text, HasSubstr("- material" + improves + "does not hold\n"));
  EXPECT_THAT(text, HasSubstr("- geometry drops by at least 22.0 % (median): holds per point, does "
                              "not hold as a sum\n"));
  EXPECT_THAT(text, HasSubstr("- material drops by at least 50.0 % (median): does not hold per "
                              "point, does not hold as a sum\n"));
  EXPECT_THAT(text, HasSubstr("- all drops by at least 30.0 % (median): holds per point, holds as "
                              "a sum\n"));
  // With the second seed the geometry's best is smaller.
  EXPECT_THAT(text, HasSubstr("- all does at least as well as the better of the others: 1 of 2 "
                              "seeds\n"));
}

TEST(Table1Report, WithoutAMeshNoiseNoImprovementIsClaimed) {
  MadeUpTable1 table = MakeTable1();
  table.result.turned.resize(2);  // of which one failed
  const std::string text = Table1Text(table.study, table.result);
  EXPECT_THAT(text, HasSubstr("two deviations of the mesh noise: mesh noise not measured\n"));
  EXPECT_THAT(text, Not(HasSubstr("Mesh noise: ")));
}

TEST(Table1Report, AStartThatFailedLeavesTheClaimOpen) {
  MadeUpTable1 table = MakeTable1();
  Table1Search& search = table.result.seeds[1].searches[0];
  search.found.evaluations[0] = {};
  search.worst = 1;
  EXPECT_THAT(Table1ClaimsText(table.study, table.result),
              HasSubstr("mesh noise: does not hold\n  (1 of 2 seeds have a start and a best point "
                        "to compare)\n"));
}

TEST(Table1Report, ASearchThatFailedIsNamedAndNotCompared) {
  MadeUpTable1 table = MakeTable1();
  table.result.seeds[1].searches[2].found.best = -1;
  EXPECT_EQ(Summarise(table.study, table.result).rows[2].seeds, 1);
  const std::string text = Table1Text(table.study, table.result);
  EXPECT_THAT(text, HasSubstr("   4  all          no evaluation succeeded\n"));
  EXPECT_THAT(text, HasSubstr("better of the others: 1 of 1 seeds\n"));
}

TEST(Table1Report, TheTextHasTheMeshesThatWereEvaluatedAndTheFirstSeed) {
  MadeUpTable1 table = MakeTable1();
  Table1Search& search = table.result.seeds[0].searches[2];
  search.worst_in_loop = MadeUpEvaluation(5e-3);
  search.best_in_loop = MadeUpEvaluation(4e-3);
  const std::string text = Table1Text(table.study, table.result);
  EXPECT_THAT(text, AllOf(HasSubstr("on 3 meshes of S_0"), HasSubstr("1.00 % of D per point")));
  EXPECT_THAT(text, HasSubstr("align), seed 3:"));
  EXPECT_THAT(text, HasSubstr("all          1.5000 -> 1.2000, 20.0 %; per point 5.0000 -> 4.0000 "
                              "mm, 20.0 %\n"));
  EXPECT_THAT(text, HasSubstr("22.5 [20.0, 25.0]"));
}

TEST(Table1Report, FilesHoldTheTable) {
  const TemporaryFolder folder;
  MadeUpTable1 table = MakeTable1();
  table.result.seeds[1].searches[2].found.best = -1;
  WriteTable1(table.study, table.result, folder.Path());
  EXPECT_EQ(FileContent(folder / "table1.txt"), Table1Text(table.study, table.result));
  const nlohmann::json json = nlohmann::json::parse(FileContent(folder / "table1.json"));
  EXPECT_EQ(json["rows"][2]["seeds"], 1);
  EXPECT_EQ(json["rows"][0]["best_per_point_m"]["least"], 3e-3);
  EXPECT_EQ(json["last_is_best"], nlohmann::json({{"seeds", 1}, {"of", 1}}));
  ASSERT_EQ(json["searches"].size(), 6u);
  EXPECT_EQ(json["searches"][2]["best"]["parameters"]["young_modulus_Pa"], 2e6);
  EXPECT_FALSE(json["searches"][5].contains("best"));
  EXPECT_THAT(FileContent(folder / "geometry.csv"), HasSubstr("residual_per_point_m"));
  EXPECT_THAT(FileContent(folder / "traces.svg"), HasSubstr("Table 1, seed 3: D per point, mm"));
}

}  // namespace
}  // namespace lacuna
