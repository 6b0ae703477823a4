#include "paper/ablation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "paper/made_up_table1.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

constexpr double kYoung = 1e6, kPoisson = 0.3;

Table1Configuration Configuration(const std::string& name, const std::string& against,
                                  bool seeks_material) {
  Table1Configuration configuration = MadeUpConfiguration(name, seeks_material);
  configuration.varies = "method";
  configuration.question = "Is it as good?";
  configuration.against = against;
  return configuration;
}

struct Ablation {
  Table1Study study;
  Table1Result result;
};
Ablation MakeAblation() {
  Ablation ablation;
  ablation.study.true_young_modulus = kYoung;
  ablation.study.true_poisson_ratio = kPoisson;
  ablation.study.configurations = {Configuration("base", "", true),
                                   Configuration("rival", "", true),
                                   Configuration("mesh", "rival", false)};
  ablation.result.seeds = {
      {1, {MadeUpSearch(3e-3, 2e6), MadeUpSearch(2.4e-3, 1.25e6, 9), MadeUpSearch(2.4e-3, 5e5)}}};
  // A spread of 1 %.
  ablation.result.turned = {MadeUpEvaluation(0.99e-3), MadeUpEvaluation(1e-3),
                            MadeUpEvaluation(1.01e-3)};
  return ablation;
}

TEST(Ablation, RowsTellWhatWasFoundAndHowFarItIsFromTheTruth) {
  const Ablation ablation = MakeAblation();
  const AblationSummary summary = SummariseAblation(ablation.study, ablation.result);
  EXPECT_NEAR(summary.mesh_noise, 0.01, 1e-12);
  ASSERT_EQ(summary.rows.size(), 3u);
  const AblationRow& rival = summary.rows[1];
  EXPECT_DOUBLE_EQ(rival.residual.start.median, 4e-3);
  EXPECT_DOUBLE_EQ(rival.residual.best.median, 2.4e-3);
  EXPECT_DOUBLE_EQ(rival.residual.best_sum.median, 300 * 2.4e-3);
  EXPECT_DOUBLE_EQ(rival.residual.drop.median, 0.4);
  EXPECT_DOUBLE_EQ(rival.optimum.modulus_factor.median, 1.25);
  EXPECT_NEAR(rival.optimum.poisson_error.median, -0.05, 1e-12);
  EXPECT_EQ(rival.evaluations.median, 2);
  EXPECT_EQ(rival.seconds.median, 10);
  EXPECT_EQ(rival.against, "base");
  EXPECT_EQ(summary.rows[2].against, "rival");
}

TEST(Ablation, WordsFollowTheNumbers) {
  const Ablation ablation = MakeAblation();
  const AblationSummary summary = SummariseAblation(ablation.study, ablation.result);
  const std::string rival = summary.rows[1].shows;
  EXPECT_THAT(rival, HasSubstr("D 20.0 % lower than that of base"));
  EXPECT_THAT(rival, HasSubstr("y off by a factor 1.25 (2.00)"));
  EXPECT_THAT(rival, HasSubstr("31.4 % below D at the true y and p"));  // 1 − 2.4/3.5
  EXPECT_THAT(rival, HasSubstr("5.0 times as long"));
  // The same value as the rival's, and a mesh is not said to be a wrong material.
  const std::string mesh = summary.rows[2].shows;
  EXPECT_THAT(mesh, HasSubstr("D equals that of rival"));
  EXPECT_THAT(mesh, Not(HasSubstr("y off")));
  EXPECT_THAT(mesh, Not(HasSubstr("true y")));
}

TEST(Ablation, ARowThatFoundNothingSaysSo) {
  Ablation ablation = MakeAblation();
  ablation.result.seeds.front().searches[1].found.best = -1;
  const AblationSummary summary = SummariseAblation(ablation.study, ablation.result);
  EXPECT_EQ(summary.rows[1].shows, "no evaluation succeeded");
  EXPECT_THAT(summary.rows[2].shows, HasSubstr("no comparison"));
}

TEST(Ablation, AMeshNoiseThatWasNotMeasuredIsSaidToBeAssumed) {
  Ablation ablation = MakeAblation();
  ablation.result.turned.resize(1);
  EXPECT_THAT(
      SummariseAblation(ablation.study, ablation.result).rows[2].shows,
      HasSubstr("D equals that of rival within 2 % (mesh noise not measured; 1 % assumed)"));
  EXPECT_THAT(AblationText(ablation.study, ablation.result),
              HasSubstr("Mesh noise: not measured; 1 % of D per point is assumed\n"));
}

TEST(Ablation, WhatFailedIsNotCounted) {
  Ablation ablation = MakeAblation();
  ablation.result.seeds.push_back(ablation.result.seeds.front());
  ablation.result.seeds.back().searches[1].found.best = -1;
  ablation.result.turned.emplace_back();
  const std::string text = AblationText(ablation.study, ablation.result);
  EXPECT_THAT(text, HasSubstr("Medians of 2 seed(s)"));
  EXPECT_THAT(text, ContainsRegex("\nrival [^\n]*  1 of 2 seeds\n"));
  EXPECT_THAT(text, Not(HasSubstr("2 of 2 seeds")));
  EXPECT_THAT(text, HasSubstr("from 3 turns of S_0"));
}

TEST(Ablation, DifferenceQuotientsOfBothSignsAreToldApart) {
  Ablation ablation = MakeAblation();
  ablation.result.quotients = {{"radius_edge_ratio", 0.1, 1e-3},
                               {"radius_edge_ratio", 0.01, -4e-3},
                               {"max_volume", 0.1, 2e-3},
                               {"max_volume", 0.01, 3e-3}};
  const std::string text = AblationText(ablation.study, ablation.result);
  EXPECT_THAT(text, HasSubstr("0.1: 1.00  0.01: -4.00   (both signs: no derivative)"));
  EXPECT_THAT(text, HasSubstr("0.1: 2.00  0.01: 3.00\n"));
}

TEST(Ablation, FilesHoldTheTable) {
  const TemporaryFolder folder;
  const Ablation ablation = MakeAblation();
  WriteAblation(ablation.study, ablation.result, folder.Path());
  const nlohmann::json json = nlohmann::json::parse(FileContent(folder / "ablation.json"));
  EXPECT_EQ(json["rows"][1]["best_per_point_m"]["median"], 2.4e-3);
  EXPECT_EQ(json["rows"][2]["shows"],
            SummariseAblation(ablation.study, ablation.result).rows[2].shows);
  EXPECT_THAT(FileContent(folder / "ablation.csv"), HasSubstr("rival,method,base,1,0.004,0.0024"));
  EXPECT_THAT(FileContent(folder / "ablation.txt"), HasSubstr("Is it as good? D 20.0 % lower"));
}

TEST(Ablation, ACommaStaysInItsField) {
  const TemporaryFolder folder;
  Ablation ablation = MakeAblation();
  ablation.study.configurations[1].varies = "forces, y and p";
  WriteAblation(ablation.study, ablation.result, folder.Path());
  EXPECT_THAT(FileContent(folder / "ablation.csv"), HasSubstr("rival,\"forces, y and p\",base,1,"));
}

// Read by a spreadsheet as a formula otherwise.
TEST(Ablation, AFormulaIsWrittenAsAText) {
  const TemporaryFolder folder;
  Ablation ablation = MakeAblation();
  ablation.study.configurations[1].varies = "=1+1";
  WriteAblation(ablation.study, ablation.result, folder.Path());
  EXPECT_THAT(FileContent(folder / "ablation.csv"), HasSubstr("rival,\"'=1+1\",base,1,"));
}

// Its search would lie outside the output, or in the recording's folder.
TEST(Ablation, ANameThatIsNoFolderIsRefused) {
  const fs::path base = fs::path(LACUNA_SOURCE_DIR) / "experiments/ablation/base.yaml";
  for (const char* name : {"../evil", "..", "recording", ".hidden", "a b"}) {
    std::string text = FileContent(base);
    text.replace(text.find("name: base"), 10, std::string("name: ") + name);
    EXPECT_THAT([&] { ReadTable1(std::vector<Config>{Config::Parse(text, base)}); },
                ThrowsMessage<InputError>(HasSubstr("letters, digits")))
        << name;
  }
}

TEST(Ablation, AnUnknownRowToBeHeldAgainstIsRefused) {
  Ablation ablation = MakeAblation();
  CheckAblation(ablation.study);
  ablation.study.configurations[2].against = "revel";
  EXPECT_THAT([&] { CheckAblation(ablation.study); },
              ThrowsMessage<InputError>(HasSubstr("names no row")));
}

// NLopt's methods do not restart, so that a comparison with one that does would change two things.
TEST(Ablation, RowsOfALibraryAreComparedWithASingleDescent) {
  const Table1Study study = ReadTable1(fs::path(LACUNA_SOURCE_DIR) / "experiments/ablation");
  int compared = 0;
  for (const Table1Configuration& configuration : study.configurations) {
    const SearchMethod method = configuration.search.method;
    if (method != SearchMethod::kNloptCobyla && method != SearchMethod::kNloptBobyqa) continue;
    const auto other = std::find_if(
        study.configurations.begin(), study.configurations.end(),
        [&](const Table1Configuration& row) { return row.name == configuration.against; });
    ASSERT_NE(other, study.configurations.end()) << configuration.name;
    EXPECT_EQ(other->search.method, SearchMethod::kCobylaModern) << configuration.name;
    EXPECT_EQ(other->search.cobyla.restarts.max_restarts, 0) << configuration.name;
    ++compared;
  }
  EXPECT_EQ(compared, 2);
}

TEST(Ablation, TheFilesOfTheRepositoryAreRead) {
  const Table1Study study = ReadTable1(fs::path(LACUNA_SOURCE_DIR) / "experiments/ablation");
  CheckAblation(study);
  EXPECT_EQ(study.configurations.front().name, "base");
  for (const Table1Configuration& configuration : study.configurations) {
    EXPECT_FALSE(configuration.varies.empty()) << configuration.name;
    EXPECT_FALSE(configuration.question.empty()) << configuration.name;
  }
}

}  // namespace
}  // namespace lacuna
