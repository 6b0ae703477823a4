#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "calibration/calibration_problem.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "experiment/reference_body.h"
#include "plan/planned_recording.h"
#include "plan/protocol.h"
#include "prediction/played_recording.h"
#include "prediction/predicted_body.h"
#include "prediction/prediction_study_reader.h"
#include "scan/recording.h"
#include "support/temporary_folder.h"
#include "trials/follow_up.h"
#include "trials/trial_report.h"
#include "trials/trial_run.h"
#include "trials/trial_simulation.h"
#include "trials/trial_suite.h"

namespace lacuna {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

TrialSuite SmallSuite() {
  return ReadTrialSuite(Config::Parse(R"(schema_version: 1
name: small
seed: 11
controls: 2
hard_controls: 4
effects: [drag]
factors: [1, 4]
recordings: [1]
removed: [drag]
pairs: 0
)",
                                      "small.yaml"));
}

TEST(TrialSuite, HasEveryGroupAndIsReproducible) {
  const std::vector<TrialCase> cases = CasesOf(SmallSuite()), again = CasesOf(SmallSuite());
  ASSERT_EQ(cases.size(), 2u + 4u + 2u + 1u);
  std::vector<std::string> nuisances;
  for (size_t k = 0; k < cases.size(); ++k) {
    EXPECT_EQ(cases[k].seed, again[k].seed);
    EXPECT_EQ(cases[k].young_modulus, again[k].young_modulus);
    nuisances.push_back(cases[k].nuisance);
  }
  for (const char* nuisance : {"grip", "bad_frame", "coarse_mesh", "time_jitter"})
    EXPECT_THAT(nuisances, Contains(nuisance));
  EXPECT_EQ(cases[6].group, TrialGroup::kRemoved);
  EXPECT_EQ(cases[7].hidden[0].factor, 1);
  EXPECT_EQ(cases[8].hidden[0].factor, 4);
}

TEST(TrialSimulation, TheTrueModelFitsTheDepthCameras) {
  const TemporaryFolder folder;
  const TrialCase trial = DrawCase("scanned", TrialGroup::kControl, 5, 1, /*is_scanned=*/true, "");
  SimulateCase(trial, folder.Path(), /*rough=*/true);
  const PredictionStudy study = ReadPredictionStudy(Config::Load(folder / "experiment.yaml"));
  ASSERT_NE(study.recordings.at(0).scans, nullptr);
  const CalibrationProblem problem(study, MakeReferenceBody(study).mesh);
  Eigen::VectorXd values = problem.Start();
  values.head(3) << trial.young_modulus, trial.poisson_ratio, trial.damping;
  ASSERT_EQ(values.size(), 6);  // the hand's force last
  values.tail(3) = trial.hold_forces[0];
  const ResidualEvaluation at_truth = problem.Predict(values, false);
  ASSERT_TRUE(at_truth.usable) << at_truth.message;
  EXPECT_LT(RootMeanSquare(at_truth), 1.5);
  EXPECT_GT(RootMeanSquare(problem.Predict(problem.Start(), false)), 5);
}

double Distance(const std::vector<Eigen::Matrix3Xd>& a, const std::vector<Eigen::Matrix3Xd>& b) {
  double sum = 0;
  for (size_t f = 0; f < a.size(); ++f) sum += (a[f] - b[f]).squaredNorm() / a[f].size();
  return std::sqrt(sum / a.size());
}

// The true bar does what each stock protocol says: the model with the true parameters predicts it.
TEST(FollowUps, TheTrueBarFollowsThePlan) {
  const TemporaryFolder folder;
  const TrialCase trial = DrawCase("planned", TrialGroup::kControl, 5, 1, false, "");
  SimulateCase(trial, folder.Path(), /*rough=*/true);
  const PredictionStudy read = ReadPredictionStudy(Config::Load(folder / "experiment.yaml"));
  const TetMesh mesh = MakeReferenceBody(read).mesh;
  const CalibrationProblem problem(read, mesh);
  Eigen::VectorXd values = problem.Start();
  values.head(3) << trial.young_modulus, trial.poisson_ratio, trial.damping;
  const PredictionStudy study = problem.StudyAt(values);
  std::vector<Eigen::Matrix3Xd> repeated;
  std::vector<std::string> names;
  for (const Protocol& protocol : StockProtocols(study, mesh)) {
    PlannedRecording planned = PlanRecording(protocol, study, mesh);
    planned.item.hold->force = PlannedHoldForce(protocol, trial.hold_forces[0]);
    const RecordingModel model(study, planned.item, mesh, problem.body(), {});
    const PlayedRecording played = Play(model, PlayedNuisances(model));
    ASSERT_TRUE(played.summary.IsUsable()) << protocol.name;
    const Markers seen =
        RecordTruth(trial, protocol, planned, trial.hold_forces[0], 2, /*rough=*/true).markers;
    EXPECT_LT(Distance(seen.positions, played.markers), 8e-4) << protocol.name;
    names.push_back(protocol.name);
    if (protocol.name == "repeat") {
      repeated = seen.positions;
    } else if (seen.positions.size() == repeated.size() &&
               seen.positions[0].cols() == repeated[0].cols()) {
      EXPECT_GT(Distance(seen.positions, repeated), 1e-3) << protocol.name;
    }
  }
  for (const char* name : {"repeat", "longer", "pull twice", "turn about y", "shake along z",
                           "added mass", "more markers"})
    EXPECT_THAT(names, Contains(name));
}

TEST(Trials, FindAStrongDragAndKeepTheOutcome) {
  const TemporaryFolder folder;
  TrialSuite suite = SmallSuite();
  suite.controls = suite.hard_controls = 0;
  suite.factors = {4};
  suite.removed.clear();
  const std::vector<TrialCase> cases = CasesOf(suite);
  ASSERT_EQ(cases.size(), 1u);
  ASSERT_TRUE(MakeCase(cases[0], folder.Path()));
  const std::filesystem::path own = folder / cases[0].name;
  const TrialCase sealed = ReadCase(own);
  EXPECT_EQ(sealed.hidden[0].type, "drag");
  EXPECT_GT(sealed.hidden[0].parameters.at("coefficient"), 1);  // kg/m³, above the drag of air
  // The truth that is kept of a reported case reproduces its recordings.
  const std::string recorded = FileContent(own / "recording_1/markers.csv");
  std::filesystem::remove_all(own / "recording_1");
  std::filesystem::remove(own / "experiment.yaml");
  ASSERT_TRUE(MakeCase(cases[0], folder.Path()));
  EXPECT_EQ(FileContent(own / "recording_1/markers.csv"), recorded);

  EXPECT_TRUE(RunTrials(folder.Path(), 1));
  const TrialOutcome outcome = ReadTrialOutcome(own);
  ASSERT_TRUE(outcome.simulated);
  EXPECT_GT(outcome.simulated->named + outcome.simulated->open, 0.8);
  ASSERT_FALSE(outcome.ranked.empty());
  // Drag and mass damping are look-alikes: drag is first or second in the ranking.
  EXPECT_TRUE(outcome.ranked[0] == "drag" || outcome.ranked[1] == "drag");
  EXPECT_TRUE(outcome.verdict == Verdict::kMissing || outcome.verdict == Verdict::kAmbiguous)
      << VerdictName(outcome.verdict);
  ASSERT_TRUE(outcome.has_truth);
  EXPECT_LT(outcome.error_after, outcome.error_before);
  // The size is 20 standard deviations of the noise (4 times the detectable size), so noise alone
  // gives an error of 5 %; errors of the model add to it.
  EXPECT_LT(outcome.relative_error, 0.3);

  const TrialReport report = ReportTrials(folder.Path());
  ASSERT_EQ(report.tallies.size(), 1u);
  EXPECT_EQ(report.tallies[0].cases, 1);
  EXPECT_EQ(report.tallies[0].fitted, 1);
  EXPECT_TRUE(report.unfinished.empty());
}

// Another draw would not help where a file cannot be written.
TEST(Trials, AreNotDrawnAgainBecauseAFileCannotBeWritten) {
  const TemporaryFolder folder;
  TrialSuite suite = SmallSuite();
  suite.controls = suite.hard_controls = 0;
  suite.removed.clear();
  const TrialCase trial = CasesOf(suite).at(0);
  const std::filesystem::path own = folder / trial.name;
  MakeFolder(own);
  WriteFileAtomically(own / "recording_1", "stands where a folder should be");
  EXPECT_THROW(MakeCase(trial, folder.Path()), InputError);
  EXPECT_FALSE(std::filesystem::exists(own / "skipped.txt"));
  EXPECT_FALSE(std::filesystem::exists(own / "truth.json"));
}

TEST(TrialRates, CountsDecidableCasesAndReliability) {
  FinishedTrial finished;
  finished.trial.group = TrialGroup::kOneEffect;
  finished.trial.hidden = {{"drag", {}, {}, 2}};
  finished.outcome.verdict = Verdict::kMissing;
  finished.outcome.named = {"drag"};
  finished.outcome.simulated =
      RecordedPower{.truth = {"drag"}, .named = 0.9, .wrong_member = 0.05, .most_wrong = ""};
  using Kind = HypothesisProbability::Kind;
  // The second hypothesis contains a nuisance that every model has here.
  finished.outcome.probabilities = {
      {.kind = Kind::kEffect, .names = {"drag", "clock"}, .probability = 0.9},
      {.kind = Kind::kEffect, .names = {"mass_damping"}, .probability = 0.1}};
  FinishedTrial open = finished;
  open.outcome.verdict = Verdict::kAmbiguous;
  open.outcome.named = {"mass_damping", "drag"};
  open.outcome.simulated->named = 0.3;
  std::swap(open.outcome.probabilities[0].probability, open.outcome.probabilities[1].probability);
  FinishedTrial removed = finished;
  removed.trial.group = TrialGroup::kRemoved;
  removed.outcome.verdict = Verdict::kNotInLibrary;
  removed.outcome.simulated =
      RecordedPower{.truth = {"drag"}, .wrong_member = 0.02, .unknown = 0.95, .most_wrong = ""};
  FinishedTrial faulty = finished;
  faulty.trial = {};
  faulty.trial.group = TrialGroup::kHardControl;
  faulty.trial.nuisance = "time_jitter";
  faulty.outcome.verdict = Verdict::kNuisance;
  faulty.outcome.probabilities = {
      {.kind = Kind::kNuisance, .names = {"time_jitter"}, .probability = 0.99}};

  // The effect alone and beside a nuisance are one statement.
  FinishedTrial twice = finished;
  twice.outcome.probabilities = {
      {.kind = Kind::kEffect, .names = {"drag", "clock"}, .probability = 0.5},
      {.kind = Kind::kEffect, .names = {"drag"}, .probability = 0.45}};
  FinishedTrial outside = removed;
  outside.outcome.verdict = Verdict::kMissing;
  outside.outcome.named = {"gravity"};

  const TrialRates rates = RatesOf({finished, open, removed, faulty, twice, outside});
  EXPECT_EQ(rates.decidable_named.part, 2);
  EXPECT_EQ(rates.decidable_named.whole, 2);
  EXPECT_NEAR(rates.named.simulated, 2.1, 1e-12);
  EXPECT_EQ(rates.named.simulated_cases, 3);
  EXPECT_NEAR(rates.wrong_member.simulated, 0.15, 1e-12);
  EXPECT_NEAR(rates.removed_member.simulated, 0.04, 1e-12);
  EXPECT_NEAR(rates.not_in_library.simulated, 1.9, 1e-12);
  EXPECT_EQ(rates.not_in_library.simulated_cases, 2);
  EXPECT_EQ(rates.decidable_not_in_library.part, 1);
  EXPECT_EQ(rates.decidable_not_in_library.whole, 2);
  EXPECT_EQ(rates.not_in_library.part, 1);
  EXPECT_EQ(rates.removed_outside.part, 1);
  EXPECT_EQ(rates.named_in_hard_controls.part, 0);
  EXPECT_EQ(rates.reliability[0].statements, 2);  // 0.1 right, 0.1 wrong
  EXPECT_EQ(rates.reliability[0].right, 1);
  EXPECT_EQ(rates.reliability[4].statements, 4);
  EXPECT_EQ(rates.reliability[4].right, 3);
  EXPECT_NEAR(rates.reliability[4].stated, 3.74, 1e-12);
  const nlohmann::json json = RatesToJson(rates);
  EXPECT_EQ(json.at("calibration").size(), 2u);
  // The lines "another one of its family is named" and "one of another family is named".
  EXPECT_NEAR(json.at("rates").at(5).at("predicted").get<double>(), 0.05, 1e-12);
  EXPECT_TRUE(json.at("rates").at(6).at("predicted").is_null());
  EXPECT_NEAR(json.at("calibration").at(1).at("frequency").get<double>(), 0.75, 1e-12);
}

// Writes a case with an invented outcome.
void Write(const std::filesystem::path& folder, const TrialCase& trial,
           const TrialOutcome& outcome) {
  MakeFolder(folder / trial.name);
  WriteCase(trial, folder / trial.name);
  WriteTrialOutcome(outcome, folder / trial.name);
}

TEST(TrialReport, CountsCorrectWrongAndAmbiguousVerdicts) {
  const TemporaryFolder folder;
  TrialSuite suite = SmallSuite();
  suite.controls = 1;
  suite.hard_controls = 0;
  suite.factors = {2, 2, 2};
  std::vector<TrialCase> cases = CasesOf(suite);
  TrialOutcome outcome;
  outcome.verdict = Verdict::kMissing;
  outcome.named = {"gravity"};
  Write(folder.Path(), cases[0], outcome);  // a false alarm
  outcome.named = {"drag"};
  outcome.ranked = {"drag", "mass_damping"};
  outcome.has_truth = true;
  outcome.error_after = 1.1;
  outcome.relative_error = 0.1;
  outcome.covered = {1};
  Write(folder.Path(), cases[2], outcome);  // right
  outcome.verdict = Verdict::kAmbiguous;
  outcome.named = {"mass_damping", "drag"};
  outcome.ranked = {"mass_damping", "drag"};
  outcome.error_after = 1.3;
  outcome.covered = {0};
  Write(folder.Path(), cases[3], outcome);  // counted in the top 2
  outcome.verdict = Verdict::kMissing;
  outcome.named = {"mass_damping"};
  outcome.ranked = {"mass_damping", "gravity"};
  Write(folder.Path(), cases[4], outcome);  // wrong
  Write(folder.Path(), cases[1], outcome);  // removed from the library: any name is wrong

  const TrialReport report = ReportTrials(folder.Path());
  ASSERT_EQ(report.tallies.size(), 3u);  // control, one_effect, removed
  const TrialTally& control = report.tallies[0];
  EXPECT_EQ(control.wrong, 1);
  const TrialTally& effect = report.tallies[1];
  EXPECT_EQ(effect.cases, 3);
  EXPECT_EQ(effect.top1, 1);
  EXPECT_EQ(effect.top2, 2);
  EXPECT_EQ(effect.wrong, 1);
  EXPECT_EQ(effect.at_noise, 1);
  EXPECT_EQ(effect.covered, 1);
  EXPECT_EQ(effect.intervals, 3);
  EXPECT_EQ(report.tallies[2].wrong, 1);
  EXPECT_EQ(report.confusion.at("drag").at("mass_damping"), 1);
  const TrialRates& rates = report.rates;
  EXPECT_EQ(rates.named_in_controls.part, 1);
  EXPECT_EQ(rates.named.part, 1);
  EXPECT_EQ(rates.named.whole, 3);
  EXPECT_EQ(rates.wrong_member.part, 1);
  EXPECT_EQ(rates.outside_family.part, 0);
  EXPECT_EQ(rates.family.part, 3);
  EXPECT_EQ(rates.removed_member.part, 1);
  EXPECT_THAT(ReportInWords(report), HasSubstr("drag (removed)"));
}

TEST(FollowUps, AreCountedBesideWhatThePlanPredicted) {
  const TemporaryFolder folder;
  TrialSuite suite = SmallSuite();
  suite.controls = suite.hard_controls = 0;
  suite.removed.clear();
  suite.factors = {1, 1, 1};
  const std::vector<TrialCase> cases = CasesOf(suite);
  ASSERT_EQ(cases.size(), 3u);
  TrialOutcome open, right, wrong;
  open.verdict = Verdict::kAmbiguous;
  open.named = {"mass_damping", "drag"};
  right.verdict = wrong.verdict = Verdict::kMissing;
  right.named = {"drag"};
  wrong.named = {"mass_damping"};
  EXPECT_TRUE(IsOpen(cases[0], open));
  EXPECT_FALSE(IsOpen(cases[0], right));
  TrialOutcome fault = right;
  fault.verdict = Verdict::kNuisance;
  EXPECT_FALSE(IsOpen(cases[0], fault));
  fault.verdict = Verdict::kAdequate;
  EXPECT_TRUE(IsOpen(cases[0], fault));
  const auto keep = [&](const TrialCase& trial, const CaseFollowUps& made) {
    Write(folder.Path(), trial, open);
    const std::vector<std::filesystem::path> folders = FollowUpFolders(folder / trial.name);
    for (const auto& [own, outcome] :
         {std::pair{folders[0], right}, std::pair{folders[1], wrong}}) {
      MakeFolder(own);
      WriteTrialOutcome(outcome, own);
    }
    WriteFollowUps(made, folder / trial.name);
  };
  const FollowUp best{"pull twice", 0.9, {}}, random{"repeat", std::nullopt, {}};
  keep(cases[0], {"", best, random});
  keep(cases[1], {"no other", best, std::nullopt});
  Write(folder.Path(), cases[2], open);  // not followed yet

  const FollowUpReport report = ReportFollowUps(folder.Path());
  EXPECT_EQ(report.open, 3);
  EXPECT_EQ(report.waiting, 1);
  EXPECT_EQ(report.unpaired, 1);
  ASSERT_EQ(report.tallies.size(), 2u);
  EXPECT_EQ(report.tallies[0].cases, 1);
  EXPECT_EQ(report.tallies[0].named, 1);
  EXPECT_NEAR(report.tallies[0].predicted, 0.9, 1e-12);
  EXPECT_EQ(report.tallies[1].cases, 1);
  EXPECT_EQ(report.tallies[1].named, 0);
  EXPECT_EQ(report.tallies[1].wrong, 1);
  EXPECT_EQ(report.tallies[1].predicted_cases, 0);
  EXPECT_EQ(ReadFollowUps(folder / cases[1].name)->message, "no other");
  EXPECT_THAT(ReportInWords(ReportTrials(folder.Path())), HasSubstr("predicted 90 %"));
  WriteFileAtomically(folder / cases[1].name / "follow_up/follow_up.json", "{}");
  EXPECT_THROW(ReportFollowUps(folder.Path()), InputError);
}

}  // namespace
}  // namespace lacuna
