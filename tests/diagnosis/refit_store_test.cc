#include "diagnosis/refit_store.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "calibration/calibration_fits.h"
#include "diagnosis/diagnosis.h"
#include "diagnosis/recorded_diagnosis.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using nlohmann::json;

TEST(RefitStore, GivesBackWhatWasKeptToTheLastBit) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "refits.json";
  Calibration calibration;
  calibration.usable = true;
  calibration.message = "one";
  calibration.parameters = Eigen::Vector2d(1.0 / 3, -1e-300);
  calibration.rms = std::sqrt(2);
  calibration.predictions = 17;
  ParameterEstimate open;
  open.value = 0.1;
  open.verdict = ParameterEstimate::Verdict::kFlat;
  calibration.estimates = {open};
  RefitStore(file, {{"fit", "a"}}).Keep("key", calibration);

  const RefitStore again(file, {{"fit", "a"}});
  EXPECT_EQ(again.Find("other"), nullptr);
  const Calibration* kept = again.Find("key");
  ASSERT_NE(kept, nullptr);
  EXPECT_TRUE(kept->usable);
  EXPECT_EQ(kept->message, "one");
  EXPECT_EQ(kept->parameters, calibration.parameters);
  EXPECT_EQ(kept->rms, calibration.rms);
  EXPECT_EQ(kept->predictions, 17);
  ASSERT_EQ(kept->estimates.size(), 1u);
  EXPECT_EQ(kept->estimates[0].value, 0.1);
  EXPECT_EQ(kept->estimates[0].deviation, std::numeric_limits<double>::infinity());
  EXPECT_EQ(kept->estimates[0].low, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(kept->estimates[0].verdict, ParameterEstimate::Verdict::kFlat);
}

TEST(RefitStore, HasNothingOfAnotherFitOrOfADamagedFile) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "refits.json";
  EXPECT_EQ(RefitStore(file, {{"fit", "a"}}).Find("key"), nullptr);
  RefitStore(file, {{"fit", "a"}}).Keep("key", {});
  EXPECT_EQ(RefitStore(file, {{"fit", "b"}}).Find("key"), nullptr);
  const std::string text = FileContent(file);
  std::ofstream(file) << text.substr(0, text.size() / 2);
  EXPECT_EQ(RefitStore(file, {{"fit", "a"}}).Find("key"), nullptr);
  json changed = json::parse(text);
  changed["fits"]["key"].erase("rms");
  std::ofstream(file) << changed;
  RefitStore mended(file, {{"fit", "a"}});
  EXPECT_EQ(mended.Find("key"), nullptr);
  mended.Drop();
  EXPECT_FALSE(std::filesystem::exists(file));
}

// As if the diagnosis had been stopped after some of its fits.
TEST(RefitStore, AStoppedDiagnosisContinuesToTheSameResult) {
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
    RefitStore kept(file, {{"of", "bar"}});
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
