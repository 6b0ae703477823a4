#include "calibration/fit_store.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "calibration/adaptive_time_step.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using nlohmann::json;

TEST(FitStore, GivesBackWhatWasKeptToTheLastBit) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "fits.json";
  Calibration calibration;
  calibration.usable = true;
  calibration.message = "one";
  calibration.is_out_of_budget = true;
  calibration.iterations = 3;
  calibration.start_rms = 1e3 / 7;
  calibration.parameters = Eigen::Vector2d(1.0 / 3, -1e-300);
  calibration.rms = std::sqrt(2);
  calibration.predictions = 17;
  ParameterEstimate open;
  open.value = 0.1;
  open.determination = Determination::kFlat;
  calibration.estimates = {open};
  FitStore(file, {{"fit", "a"}}).Keep("key", calibration);

  const FitStore again(file, {{"fit", "a"}});
  EXPECT_EQ(again.Find("other"), nullptr);
  const Calibration* kept = again.Find("key");
  ASSERT_NE(kept, nullptr);
  EXPECT_TRUE(kept->usable);
  EXPECT_EQ(kept->message, "one");
  EXPECT_EQ(kept->parameters, calibration.parameters);
  EXPECT_TRUE(kept->is_out_of_budget);
  EXPECT_EQ(kept->iterations, 3);
  EXPECT_EQ(kept->start_rms, calibration.start_rms);
  EXPECT_EQ(kept->rms, calibration.rms);
  EXPECT_EQ(kept->predictions, 17);
  ASSERT_EQ(kept->estimates.size(), 1u);
  EXPECT_EQ(kept->estimates[0].value, 0.1);
  EXPECT_EQ(kept->estimates[0].deviation, std::numeric_limits<double>::infinity());
  EXPECT_EQ(kept->estimates[0].low, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(kept->estimates[0].determination, Determination::kFlat);
}

TEST(FitStore, HasNothingOfAnotherFitOrOfADamagedFile) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "fits.json";
  EXPECT_EQ(FitStore(file, {{"fit", "a"}}).Find("key"), nullptr);
  FitStore(file, {{"fit", "a"}}).Keep("key", {});
  EXPECT_EQ(FitStore(file, {{"fit", "b"}}).Find("key"), nullptr);
  const std::string text = FileContent(file);
  std::ofstream(file) << text.substr(0, text.size() / 2);
  EXPECT_EQ(FitStore(file, {{"fit", "a"}}).Find("key"), nullptr);
  json changed = json::parse(text);
  changed["fits"]["key"].erase("rms");
  std::ofstream(file) << changed;
  FitStore mended(file, {{"fit", "a"}});
  EXPECT_EQ(mended.Find("key"), nullptr);
  mended.Drop();
  EXPECT_FALSE(std::filesystem::exists(file));
}

// As if the fit had been stopped after some of its parts.
TEST(StoppedFit, ContinuesToTheSameBits) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar(HeldBarTruth()));
  const TetMesh mesh = BarMesh({7, 1, 1}, 2);
  const std::filesystem::path file = folder / "fits.json";
  SilentProgress progress;
  const auto fit = [&](FitStore* kept) {
    PredictionStudy study = ReadBarStudy(folder.Path());
    return FitWithAdaptiveTimeStep(mesh, &study, &progress, kept).calibration;
  };
  const Calibration alone = fit(nullptr);
  ASSERT_TRUE(alone.usable) << alone.message;
  const auto with_file = [&] {
    FitStore kept(file, {{"of", "bar"}});
    return fit(&kept);
  };
  EXPECT_EQ(with_file().parameters, alone.parameters);
  json all = json::parse(FileContent(file));
  const size_t parts = all.at("fits").size();
  ASSERT_GE(parts, 2u);
  all["fits"].erase(all["fits"].begin());
  std::ofstream(file) << all;
  const Calibration resumed = with_file();
  EXPECT_EQ(resumed.parameters, alone.parameters);
  EXPECT_EQ(resumed.predictions, alone.predictions);
  EXPECT_EQ(resumed.start_rms, alone.start_rms);
  all = json::parse(FileContent(file));
  EXPECT_EQ(all.at("fits").size(), parts) << "what was kept is found again";
  // A kept part is not repeated.
  for (auto& [key, part] : all["fits"].items()) part["predictions"] = 100;
  std::ofstream(file) << all;
  EXPECT_GE(with_file().predictions, 100);
}

}  // namespace
}  // namespace lacuna
