#include <gtest/gtest.h>

#include <fstream>

#include "calibration/calibration_fits.h"
#include "diagnosis/diagnosis.h"
#include "diagnosis/recorded_diagnosis.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using nlohmann::json;

// As if the diagnosis had been stopped after some of its fits.
TEST(StoppedDiagnosis, ContinuesToTheSameResult) {
  const TemporaryFolder folder;
  HeldBarTruth truth;
  truth.alpha = 12;
  WriteBarRecording(folder.Path(), FilmHeldBar(truth));
  const PredictionStudy study = ReadBarStudy(
      folder.Path(),
      {{"  - {type: mass_damping, alpha: 1 1/s}\n", ""}, {", {name: mass_damping.alpha}", ""}});
  const TetMesh mesh = BarMesh({7, 1, 1}, 2);
  SilentProgress progress;
  const Calibration fit = FitFromStart(CalibrationProblem(study, mesh), &progress);
  ASSERT_TRUE(fit.usable) << fit.message;
  const std::filesystem::path file = folder / "refits.json";
  const auto diagnose = [&](const std::string& name) {
    const CalibrationProblem problem(study, mesh);
    FitStore kept(file, {{"of", "bar"}});
    const Diagnosis diagnosis =
        Diagnose(problem, fit.parameters, {.refits = 1, .without = {}}, &progress, &kept);
    WriteDiagnosisFile(RecordOf(diagnosis), folder / name);
    return FileContent(folder / name);
  };
  const std::string whole = diagnose("whole.json");
  json all = json::parse(FileContent(file));
  const size_t fits = all.at("fits").size();
  ASSERT_GT(fits, 2u);
  all["fits"].erase(all["fits"].begin());
  const json part = all;
  std::ofstream(file) << part;
  EXPECT_EQ(diagnose("resumed.json"), whole);
  all = json::parse(FileContent(file));
  EXPECT_EQ(all.at("fits").size(), fits) << "what was kept is found again";
  // A kept fit is not repeated.
  for (auto& [key, kept] : all["fits"].items())
    for (json& estimate : kept["estimates"]) estimate["deviation"] = 1e9;
  std::ofstream(file) << all;
  EXPECT_NE(diagnose("changed.json"), whole);
}

}  // namespace
}  // namespace lacuna
