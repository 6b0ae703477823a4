#include "trials/interval_trials.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <fstream>

#include "core/atomic_file.h"
#include "core/error.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

IntervalSuite Suite(const std::string& rest) {
  return ReadIntervalSuite(
      Config::Parse("schema_version: 1\nname: x\nseed: 3\ndraws: 5\n" + rest, "intervals.yaml"));
}

constexpr const char* kMass =
    "modelled: [attached_mass]\npriors:\n"
    "  - {name: young_modulus, mean: 120 kPa, deviation: 12 kPa}\n"
    "  - {name: attached_mass.mass, mean: 2 g, deviation: 0.4 g}\n"
    "  - {name: attached_mass.centre_x, mean: 55 mm, deviation: 4 mm}\n";

TEST(IntervalSuite, DrawsTheTruthFromThePriors) {
  const IntervalSuite suite = Suite(kMass);
  constexpr int kDraws = 400;
  Eigen::Array3d sum = Eigen::Array3d::Zero(), squares = sum;
  for (int k = 0; k < kDraws; ++k) {
    const TrialCase trial = DrawIntervalCase(suite, k);
    ASSERT_EQ(trial.modelled.size(), 1u);
    ASSERT_TRUE(trial.hidden.empty());
    const ModelledEffect& mass = trial.modelled[0];
    const Eigen::Array3d scores(std::log(trial.young_modulus / 120e3) / 0.1,
                                (mass.parameters.at("mass") - 2e-3) / 0.4e-3,
                                (mass.parameters.at("centre_x") - 0.055) / 0.004);
    sum += scores;
    squares += scores.square();
    EXPECT_EQ(mass.starts.size(), 2u) << "mass and place are fitted, and nothing else";
    EXPECT_EQ(mass.starts.at("mass"), 2e-3);
    EXPECT_EQ(mass.starts.at("centre_x"), 0.055);
  }
  // Means and variances of 400 standard normal draws are within 4 of their standard errors.
  EXPECT_LT((sum / kDraws).abs().maxCoeff(), 4 / std::sqrt(kDraws));
  EXPECT_LT((squares / kDraws - 1).abs().maxCoeff(), 4 * std::sqrt(2.0 / kDraws));
  EXPECT_EQ(DrawIntervalCase(suite, 4).modelled[0].parameters,
            DrawIntervalCase(suite, 4).modelled[0].parameters);
}

// Half of the draws of a prior at the bound of its parameter lie beyond it, where the fit cannot
// follow.
TEST(IntervalSuite, DrawsTheTruthWithinTheBoundsOfTheFit) {
  const IntervalSuite suite = Suite(
      "missing: [drag]\npriors:\n"
      "  - {name: poisson_ratio, mean: 0.499, deviation: 0.05}\n"
      "  - {name: drag.coefficient, mean: 0 kg/m^3, deviation: 10 kg/m^3}\n");
  for (int k = 0; k < 50; ++k) {
    const TrialCase trial = DrawIntervalCase(suite, k);
    EXPECT_LT(trial.poisson_ratio, 0.5);
    EXPECT_GE(trial.hidden.at(0).parameters.at("coefficient"), 0);
    EXPECT_EQ(TextOfCase(DrawIntervalCase(suite, k)), TextOfCase(trial));
  }
  const IntervalSuite wide =
      Suite("priors: [{name: poisson_ratio, mean: 0.4, deviation: 1000000000}]\n");
  EXPECT_THAT([&] { DrawIntervalCase(wide, 0); },
              ThrowsMessage<InputError>(HasSubstr("the prior of poisson_ratio")));
}

std::string Refusal(const std::string& rest) {
  try {
    Suite(rest);
  } catch (const InputError& problem) {
    return problem.what();
  }
  return "nothing was refused";
}

TEST(IntervalSuite, RefusesPriorsThatDoNotBelongToTheTruth) {
  EXPECT_THAT(Refusal("priors: [{name: drag.coefficient, mean: 1 kg/m^3, deviation: 1 kg/m^3}]\n"),
              AllOf(HasSubstr("intervals.yaml:5:"),
                    HasSubstr("the truth has no parameter \"drag.coefficient\"")));
  EXPECT_THAT(Refusal("modelled: [attached_mass]\npriors: []\n"),
              AllOf(HasSubstr("intervals.yaml:5:"),
                    HasSubstr("priors has no entry for attached_mass.mass")));
}

TEST(IntervalSuite, RefusesWhatItListsTwice) {
  EXPECT_THAT(Refusal("modelled: [attached_mass, attached_mass]\n"),
              AllOf(HasSubstr("intervals.yaml:5:"), HasSubstr("listed twice")));
  EXPECT_THAT(Refusal("modelled: [drag]\nmissing: [drag]\n"),
              AllOf(HasSubstr("intervals.yaml:6:"), HasSubstr("that the model has")));
  for (const char* type : {"stiffness_damping", "gravity"})
    EXPECT_THAT(Refusal(std::string("modelled: [") + type + "]\n"),
                AllOf(HasSubstr("intervals.yaml:5:"), HasSubstr("part of every model")));
  EXPECT_THAT(Refusal("priors:\n  - {name: poisson_ratio, mean: 0.4, deviation: 0.01}\n"
                      "  - {name: poisson_ratio, mean: 0.3, deviation: 0.01}\n"),
              AllOf(HasSubstr("intervals.yaml:7:"), HasSubstr("listed twice")));
}

TEST(IntervalTrials, MeasuresTheTruthInDeviationsFromTheCentreOfTheInterval) {
  TrialCase truth;
  truth.young_modulus = 1.1e5;
  truth.poisson_ratio = 0.45;
  CalibrationRecord record;
  FittedParameter& modulus = record.parameters.emplace_back();
  modulus.name = "young_modulus";
  modulus.log_scale = true;
  modulus.estimate.value = 0.9e5;  // of a coarse mesh; the interval is centred at 1e5
  modulus.estimate.low = 1e5 * std::exp(-1.96 * 0.05);
  modulus.estimate.high = 1e5 * std::exp(1.96 * 0.05);
  modulus.at_limit = 1e5;
  FittedParameter& ratio = record.parameters.emplace_back();
  ratio.name = "poisson_ratio";
  ratio.estimate.value = 0.48;
  ratio.estimate.low = 0.48 - 1.96 * 0.02;
  ratio.estimate.high = 0.4999;                                 // cut off by the bound
  record.parameters.emplace_back().name = "recording 1.clock";  // its truth is not drawn
  const std::vector<JudgedParameter> judged = Judge(record, truth);
  ASSERT_EQ(judged.size(), 2u);
  EXPECT_NEAR(judged[0].deviations, std::log(1.1) / 0.05, 1e-3);
  EXPECT_NEAR(judged[1].deviations, -0.03 / 0.02, 1e-3);
}

// Draws as RunIntervalSuite keeps them, with the truth so many deviations from the centre.
void WriteDraw(const std::filesystem::path& folder, int number, double deviations) {
  const TrialCase trial = DrawIntervalCase(Suite(kMass), number);
  MakeFolder(folder / trial.name);
  WriteCase(trial, folder / trial.name);
  WriteFileAtomically(folder / trial.name / "intervals.json",
                      R"({"schema_version": 1, "parameters": [{"name": "E", "unit": "Pa",
 "truth": 0, "value": 0, "low": 0, "high": 0, "deviations": )" +
                          std::to_string(deviations) + "}]}");
}

TEST(IntervalTrials, TellsRightIntervalsFromThoseThatAreTooNarrow) {
  constexpr int kDraws = 40;
  // The quantiles of a standard normal distribution, by bisection.
  const auto quantile = [](double p) {
    double low = -6, high = 6;
    while (high - low > 1e-9) {
      const double middle = 0.5 * (low + high);
      (0.5 * std::erfc(-middle / std::sqrt(2.0)) < p ? low : high) = middle;
    }
    return low;
  };
  for (const double spread : {1.0, 2.0}) {
    const TemporaryFolder folder;
    for (int k = 0; k < kDraws; ++k)
      WriteDraw(folder.Path(), k, spread * quantile((k + 0.5) / kDraws));
    const IntervalReport report = ReportIntervals(folder.Path());
    ASSERT_EQ(report.tallies.size(), 1u);
    const IntervalTally& tally = report.tallies[0];
    EXPECT_EQ(tally.draws, kDraws);
    EXPECT_NEAR(tally.spread, spread, 0.05 * spread);
    if (spread == 1) {
      EXPECT_NEAR(tally.covered_50, 0.5, 0.026);
      EXPECT_NEAR(tally.covered_80, 0.8, 0.026);
      EXPECT_NEAR(tally.covered_95, 0.95, 0.026);
      EXPECT_GT(tally.p_uniform, 0.9);
    } else {
      EXPECT_NEAR(tally.covered_95, 0.67, 0.03);  // Φ(0.98) − Φ(−0.98)
      EXPECT_LT(tally.p_uniform, 0.05);
    }
  }
}

TEST(IntervalTrials, NamesTheDrawsWithoutAFit) {
  const TemporaryFolder folder;
  WriteDraw(folder.Path(), 0, 0.1);
  WriteDraw(folder.Path(), 1, 0.1);
  std::filesystem::remove(folder / "0001/intervals.json");
  WriteFileAtomically(folder / "0001/failed.txt", "an element is inverted\n");
  const IntervalReport report = ReportIntervals(folder.Path());
  ASSERT_EQ(report.failed.size(), 1u);
  EXPECT_EQ(report.failed[0], "0001: an element is inverted");
  EXPECT_THAT(IntervalReportInWords(report), HasSubstr("no fit: 0001: an element is inverted"));
}

// With elements smaller than a nanometre, the truth cannot be meshed.
TEST(IntervalTrials, NamesTheDrawsWhoseTruthCannotBeSimulated) {
  const TemporaryFolder folder;
  IntervalSuite suite = Suite("element_volume: 1e-18 mm^3\n");
  suite.draws = 2;
  EXPECT_TRUE(RunIntervalSuite(suite, folder.Path(), 2));
  const IntervalReport report = ReportIntervals(folder.Path());
  EXPECT_TRUE(report.tallies.empty());
  ASSERT_EQ(report.failed.size(), 2u);
  EXPECT_THAT(report.failed[1], AllOf(HasSubstr("0001: "), HasSubstr("tetrahedra")));
  // Another suite must not continue with these draws.
  suite.seed = 4;
  EXPECT_THROW(RunIntervalSuite(suite, folder.Path(), 2), InputError);
}

}  // namespace
}  // namespace lacuna
