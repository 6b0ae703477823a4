#include "diagnosis/ledger.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "calibration/calibration_run.h"
#include "core/config.h"
#include "diagnosis/diagnosis_run.h"
#include "diagnosis/extension_rounds.h"
#include "prediction/prediction_study_reader.h"
#include "support/held_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::HasSubstr;
using testing::Not;

FittedParameter Parameter(const std::string& name, double value, double deviation, bool log_scale) {
  FittedParameter parameter;
  parameter.name = name;
  parameter.unit = "Pa";
  parameter.log_scale = log_scale;
  parameter.estimate.value = value;
  parameter.estimate.posterior_deviation = deviation;
  return parameter;
}

// One fitted recording and one that is not.
CalibrationRecord Record(double in_fit, double held_out, double other) {
  constexpr double kNoise = 1e-4;  // m
  CalibrationRecord record;
  record.usable = true;
  record.noise = kNoise;
  const auto measure = [](double rms, int points) {
    return MisfitMeasure{points, points, rms, 2 * rms, rms / kNoise};
  };
  record.recordings = {{"a", true, kNoise, measure(in_fit, 30), measure(held_out, 10), {}},
                       {"b", false, kNoise, {}, measure(other, 30), {}}};
  return record;
}

RecordedEffect Tried(const std::string& type, double held_out_rms) {
  RecordedEffect effect;
  effect.type = type;
  effect.refitted = true;
  effect.errors = {held_out_rms, held_out_rms, 1e4 * held_out_rms, 1e4 * held_out_rms, true};
  return effect;
}

Ledger TwoModels() {
  Ledger ledger;
  CalibrationRecord before = Record(2e-4, 4e-4, 4e-4), after = Record(1e-4, 2e-4, 2e-4);
  before.parameters = {Parameter("young_modulus", 1e5, 0.1, true)};
  after.parameters = {Parameter("young_modulus", 1e5 * std::exp(0.3), 0.1, true),
                      Parameter("drag.coefficient", 3, 1, false)};
  ledger.models.push_back(MakeLedgerModel(ledger, "/runs/bar/", before, -1, ""));
  DiagnosisRecord diagnosis;
  diagnosis.verdict = "missing";
  diagnosis.effects = {"drag"};
  diagnosis.ranking = {Tried("drag", 2e-4), Tried("mass_damping", 3e-4)};
  ledger.models.back().diagnosis = diagnosis;
  ledger.models.push_back(MakeLedgerModel(ledger, "/runs/bar+drag", after, 0, "drag"));
  ledger.ending = "It ends here.";
  return ledger;
}

TEST(Ledger, TellsWhatAModelGainedAndWhatMoved) {
  const Ledger ledger = TwoModels();
  const LedgerModel& model = ledger.models[1];
  EXPECT_EQ(ledger.models[0].name, "bar");
  EXPECT_DOUBLE_EQ(ledger.models[0].errors.held_out_rms, 4e-4);
  EXPECT_DOUBLE_EQ(ledger.models[0].errors.in_fit_rms, 2e-4);
  EXPECT_DOUBLE_EQ(model.gain, 0.5);
  ASSERT_EQ(model.moves.size(), 2u);
  EXPECT_FALSE(model.moves[0].added);
  // ln(after/before) = 0.3, the parent's deviation of the logarithm 0.1.
  EXPECT_NEAR(model.moves[0].in_deviations, 3, 1e-9);
  EXPECT_TRUE(model.moves[1].added);
  EXPECT_EQ(ledger.Best().name, "bar+drag");
}

TEST(Ledger, AModelThatCouldNotBeFittedIsNeverTheBest) {
  Ledger ledger = TwoModels();
  CalibrationRecord failed;
  failed.message = "no convergence";
  ledger.models.push_back(
      MakeLedgerModel(ledger, "/runs/bar+drag+swelling", failed, 1, "swelling"));
  EXPECT_EQ(ledger.Best().name, "bar+drag");
  EXPECT_THAT(LedgerInWords(ledger), HasSubstr("the fit is not usable: no convergence"));
}

TEST(Ledger, IsWrittenAsATree) {
  const TemporaryFolder folder;
  Ledger ledger = TwoModels();
  SaveLedger(ledger, folder.Path());
  std::ifstream stream(folder / "ledger.json");
  const auto written = nlohmann::json::parse(stream);
  EXPECT_TRUE(written["finished"]);
  EXPECT_EQ(written["best"], "bar+drag");
  EXPECT_EQ(written["models"][1]["parent"], "bar");
  EXPECT_EQ(written["models"][1]["added"], "drag");
  EXPECT_NEAR(written["models"][1]["gain"], 0.5, 1e-12);
  const auto& tried = written["models"][0]["diagnosis"]["tried"];
  EXPECT_EQ(tried[0]["added"], true);
  EXPECT_EQ(tried[1]["added"], false);
  EXPECT_FALSE(written["models"][0].contains("parent"));

  const std::string text = FileContent(folder / "ledger.txt");
  EXPECT_THAT(text, HasSubstr("├── tried  mass_damping"));
  EXPECT_THAT(text, Not(HasSubstr("tried  drag")));
  EXPECT_THAT(text, HasSubstr("└── added  drag"));
  EXPECT_THAT(text, HasSubstr("50 % less than before"));
  EXPECT_THAT(text, HasSubstr("b (not fitted)"));
  EXPECT_THAT(text, HasSubstr("held-out error before   0.400 mm, 4.0 σ\n"
                              "what was missing        drag\n"
                              "held-out error after    0.200 mm, 2.0 σ\n"));
}

ProgressOptions Silent() {
  ProgressOptions silent;
  silent.style = ProgressStyle::kSilent;
  return silent;
}

// A run of a bar whose damping the model lacks.
std::filesystem::path FitBarWithoutDamping(const std::filesystem::path& folder) {
  HeldBarTruth truth;
  truth.alpha = 12;
  WriteBarRecording(folder, FilmHeldBar(truth));
  std::ofstream(folder / "bar.yaml") << BarExperiment(
      folder, {{"name: bar", "name: bar\noutput: runs/bar"},
               {"max_volume: 1000 mm^3", "max_volume: 2000 mm^3, preserve_surface: false"},
               {"  - {type: mass_damping, alpha: 1 1/s}\n", ""},
               {", {name: mass_damping.alpha}", ""}});
  Progress progress(Silent());
  EXPECT_TRUE(
      RunCalibration(ReadPredictionStudy(Config::Load(folder / "bar.yaml")), &progress).usable);
  return folder / "runs/bar";
}

TEST(ExtensionRounds, AddWhatIsMissingAndResumeToTheSameLedger) {
  const TemporaryFolder folder;
  const std::filesystem::path run = FitBarWithoutDamping(folder.Path());
  ExtensionOptions options;
  options.most_effects = 1;
  options.follow_best = true;  // drag and damping look alike here
  Progress progress(Silent());
  int changes = 0;
  const Ledger ledger = ExtendUntilDone(run, options, &progress, [&](const Ledger& now) {
    ++changes;
    std::ifstream stream(run / "ledger.json");
    EXPECT_EQ(nlohmann::json::parse(stream)["models"].size(), now.models.size());
  });
  EXPECT_GE(changes, 2);
  ASSERT_EQ(ledger.models.size(), 2u) << LedgerInWords(ledger);
  EXPECT_FALSE(ledger.ending.empty());
  EXPECT_TRUE(std::filesystem::exists(folder / "runs" / (ledger.models[1].name + ".yaml")));
  // A bar with ten times the usual damping: the model without it is wrong by far.
  EXPECT_GT(ledger.models[1].gain, 0.5);

  // Nothing is computed again, and what was found is the same to the last byte.
  EXPECT_TRUE(IsDiagnosed(run, options.diagnosis));
  const std::string kept = FileContent(run / "ledger.json");
  const auto written = std::filesystem::last_write_time(run / "diagnosis/diagnosis.json");
  ExtendUntilDone(run, options, &progress, [](const Ledger&) {});
  EXPECT_EQ(FileContent(run / "ledger.json"), kept);
  EXPECT_EQ(std::filesystem::last_write_time(run / "diagnosis/diagnosis.json"), written);

  // With other options, or another file, it is another diagnosis.
  DiagnosisOptions more = options.diagnosis;
  ++more.refits;
  EXPECT_FALSE(IsDiagnosed(run, more));
  std::ofstream(run / "diagnosis/diagnosis.json", std::ios::app) << "\n";
  EXPECT_FALSE(IsDiagnosed(run, options.diagnosis));
}

}  // namespace
}  // namespace lacuna
