#include "diagnosis/extension_rounds.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "calibration/calibration_run.h"
#include "core/config.h"
#include "diagnosis/diagnosis_run.h"
#include "prediction/prediction_study_reader.h"
#include "report/ledger_report.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

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
  SilentProgress progress;
  EXPECT_TRUE(
      RunCalibration(ReadPredictionStudy(Config::Load(folder / "bar.yaml")), &progress).usable);
  return folder / "runs/bar";
}

TEST(ExtensionRounds, AddTheMissingEffectAndResumeToTheSameLedger) {
  const TemporaryFolder folder;
  const std::filesystem::path run = FitBarWithoutDamping(folder.Path());
  ExtensionOptions options;
  options.most_effects = 1;
  options.follow_best = true;  // drag and damping look alike here
  SilentProgress progress;
  int changes = 0;
  const Ledger ledger = ExtendUntilDone(run, options, &progress, [&](const Ledger& now) {
    ++changes;
    std::ifstream stream(run / "ledger.json");
    EXPECT_EQ(nlohmann::json::parse(stream)["models"].size(), now.models.size());
  });
  EXPECT_GE(changes, 2);
  ASSERT_EQ(ledger.models.size(), 2u) << LedgerReport(ledger);
  EXPECT_TRUE(ledger.HasEnded());
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
