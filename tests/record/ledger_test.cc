#include "record/ledger.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "support/small_ledger.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

TEST(Ledger, MeasuresTheGainAndTheMovedParameters) {
  const Ledger ledger = SmallLedger();
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
  Ledger ledger = SmallLedger();
  CalibrationRecord failed;
  failed.message = "no convergence";
  ledger.models.push_back(
      MakeLedgerModel(ledger, "/runs/bar+drag+swelling", failed, 1, "swelling"));
  EXPECT_EQ(ledger.Best().name, "bar+drag");
}

// All components of a size must leave 0 for the effect to count; a place says nothing of it.
TEST(Ledger, AnEffectWhoseSizeMayBeZeroDoesNotCount) {
  RecordedEffect gravity;
  gravity.type = "gravity";
  gravity.sizes = {{"x", "m/s^2"}, {"y", "m/s^2"}};
  DiagnosisRecord diagnosis;
  diagnosis.ranking = {gravity};
  CalibrationRecord record;
  record.usable = true;
  EXPECT_FALSE(SizeMayBeZero(record, diagnosis, "gravity"));  // has no size here
  const auto add = [&](const std::string& name, double low, double high) {
    FittedParameter& parameter = record.parameters.emplace_back();
    parameter.name = name;
    parameter.estimate.low = low;
    parameter.estimate.high = high;
  };
  add("young_modulus", 1, 2);
  add("gravity.x", -1, 1);
  add("gravity.y", 0, 3);
  EXPECT_TRUE(SizeMayBeZero(record, diagnosis, "gravity"));
  record.parameters.back().estimate.low = 0.1;
  EXPECT_FALSE(SizeMayBeZero(record, diagnosis, "gravity"));

  Ledger ledger = SmallLedger();
  ledger.models.back().may_be_zero = true;
  EXPECT_EQ(ledger.Best().name, "bar");
}

// The places of the points may hide, within their uncertainty, what an effect explains.
TEST(Ledger, AnEffectCountsThatTheFittedPlacesHide) {
  Ledger ledger = SmallLedger();
  LedgerModel& model = ledger.models.back();
  model.gain = model.gain_with_reactions = -0.001;
  model.gain_at_measured_places = 0.4;
  EXPECT_TRUE(LowersError(model, 0));
  EXPECT_TRUE(LowersError(model, 0.3));
  EXPECT_FALSE(LowersError(model, 0.5));
  EXPECT_EQ(ledger.Best().name, "bar+drag");
  model.gain = model.gain_with_reactions = -0.1;  // no longer the same error
  EXPECT_FALSE(LowersError(model, 0));
  EXPECT_EQ(ledger.Best().name, "bar");
  model.gain = model.gain_with_reactions = -0.001;
  model.gain_at_measured_places = 0.01;
  EXPECT_FALSE(LowersError(model, 0));
  model.gain = 0.001;
  EXPECT_TRUE(LowersError(model, 0));
}

// Where grips prescribe the motion, only the force tells what is missing.
TEST(Ledger, AnEffectCountsThatOnlyTheForceShows) {
  const auto fit = [](double points, double force) {
    CalibrationRecord record;
    record.usable = true;
    FittedRecording& recording = record.recordings.emplace_back();
    recording.held_out.points = 100;
    recording.held_out.rms = 1e-4 * points;
    recording.held_out.rms_over_sigma = points;
    FittedReaction& reaction = recording.reactions.emplace_back();
    reaction.held_out.values = 60;
    reaction.held_out.rms_over_sigma = force;
    return record;
  };
  Ledger ledger;
  ledger.models.push_back(MakeLedgerModel(ledger, "bar", fit(1, 22), -1, ""));
  const LedgerModel child = MakeLedgerModel(ledger, "bar+drag", fit(1.05, 11), 0, "drag");
  EXPECT_LT(child.gain, -0.02);
  // 300 coordinates and 60 forces.
  EXPECT_NEAR(child.gain_with_reactions,
              1 - std::sqrt((300 * 1.05 * 1.05 + 60 * 121) / (300 + 60 * 484.)), 1e-12);
  EXPECT_TRUE(LowersError(child, 0.4));
  EXPECT_FALSE(LowersError(MakeLedgerModel(ledger, "bar+drag", fit(1.05, 22), 0, "drag"), 0));
}

TEST(Ledger, IsWrittenAsATree) {
  const TemporaryFolder folder;
  WriteLedgerFile(SmallLedger(), folder.Path());
  std::ifstream stream(folder / "ledger.json");
  const auto written = nlohmann::json::parse(stream);
  EXPECT_TRUE(written["finished"]);
  EXPECT_EQ(written["ending"]["reason"], "little_gain");
  EXPECT_EQ(written["best"], "bar+drag");
  EXPECT_DOUBLE_EQ(written["models"][0]["errors"]["held_out_rms_over_sigma"].get<double>(), 4);
  EXPECT_EQ(written["models"][0]["diagnosis"]["verdict"], "missing");
  EXPECT_EQ(written["models"][1]["parent"], "bar");
  EXPECT_EQ(written["models"][1]["added"], "drag");
  EXPECT_NEAR(written["models"][1]["gain"], 0.5, 1e-12);
  const auto& tried = written["models"][0]["diagnosis"]["tried"];
  EXPECT_EQ(tried[0]["added"], true);
  EXPECT_EQ(tried[1]["added"], false);
  EXPECT_FALSE(written["models"][0].contains("parent"));
}

}  // namespace
}  // namespace lacuna
