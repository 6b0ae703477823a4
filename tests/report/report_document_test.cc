#include "report/report_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/error.h"
#include "core/hash.h"
#include "core/json_file.h"
#include "record/manifest.h"
#include "record/packed_array.h"
#include "record/plan_record.h"
#include "report/reported_run.h"
#include "support/small_ledger.h"
#include "support/small_run.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string WhyRefused(const std::vector<std::filesystem::path>& runs) {
  try {
    ReportDocument(runs);
  } catch (const InputError& problem) {
    return problem.what();
  }
  return "";
}

// One run of the first model of SmallLedger().
void WriteFit(const std::filesystem::path& folder, const SmallRun& run) {
  CalibrationRecord record = SmallLedger().models[0].record;
  record.recordings[0].held_out.frames = run.held_out_frames;
  WriteSmallFit(folder, run, record);
}

TEST(ReportDocument, ShowsTheModelsOfTheLedger) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  const json document = ReportDocument({folder / "bar"});
  const json& run = document.at("runs").at(0);
  EXPECT_EQ(run.at("kind"), "prediction");
  EXPECT_EQ(run.at("models").size(), 2u);
  EXPECT_EQ(run.at("models").at(1).at("added"), "drag");
  EXPECT_EQ(run.at("models").at(1).at("label"), "with drag");
  EXPECT_EQ(run.at("models").at(0).at("errors").at("held_out_over_sigma"), 4);
  EXPECT_EQ(run.at("ledger").at("models").size(), 2u);
  EXPECT_EQ(run.at("models").at(0).at("diagnosis").at("verdict"), "missing");
  EXPECT_NEAR(run.at("noise").get<double>(), std::sqrt(3.0) * 1e-4, 1e-12);
  // A run of every kind has all keys.
  for (const char* key : {"reconstruction", "table1", "ablation", "trials", "intervals"}) {
    ASSERT_TRUE(run.contains(key)) << key;
    EXPECT_TRUE(run.at(key).is_null()) << key;
  }
  EXPECT_THAT(run.at("notes"), IsEmpty());
  EXPECT_THAT(document.at("sentences").at(0).get<std::string>(),
              HasSubstr("at marker tip and from 0.31 s to 0.35 s of recording a."));
  const std::vector<std::string> commands = run.at("provenance").at("commands");
  EXPECT_THAT(commands, testing::Contains(HasSubstr("diagnose")));
  EXPECT_EQ(run.at("provenance").at("inputs").at("a/markers.csv"), "1f2e3d");
}

TEST(ReportDocument, AnAddedModelIsShownAfterTheOneThatItWasMadeFrom) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  const json run = ReportDocument({folder / "bar+drag"}).at("runs").at(0);
  EXPECT_EQ(run.at("models").size(), 2u);
  EXPECT_EQ(run.at("models").at(0).at("name"), "bar");
  EXPECT_EQ(run.at("models").at(1).at("added"), "drag");
}

// A run with another recording, such as a planned one, or without the effect of its name is no
// model that `lacuna add` has made.
TEST(ReportDocument, ARunBesideIsShownOnlyIfItsModelLacksTheAddedEffect) {
  const TemporaryFolder folder;
  WriteFit(folder / "bar", {});
  const auto models = [&](const SmallRun& run) {
    WriteFit(folder / run.name, run);
    return ReportDocument({folder / run.name}).at("runs").at(0).at("models").size();
  };
  EXPECT_EQ(models({.name = "bar+drag", .effects = {"drag"}}), 2u);
  EXPECT_EQ(models({.name = "bar+shake", .effects = {"drag"}}), 1u);
  EXPECT_EQ(models({.name = "bar+swelling", .content = "more", .effects = {"swelling"}}), 1u);
  // Both have it.
  WriteFit(folder / "bar", {.effects = {"drag"}});
  EXPECT_EQ(models({.name = "bar+drag", .effects = {"drag"}}), 1u);
}

// The same runs, of which the second is shown together with the first.
TEST(ReportDocument, ARunIsComparedWithTheOneThatItWasMadeFrom) {
  const TemporaryFolder folder;
  WriteFit(folder / "bar", {});
  WriteFit(folder / "bar+drag", {.name = "bar+drag", .effects = {"drag"}});
  const json document = ReportDocument({folder / "bar", folder / "bar+drag"});
  EXPECT_EQ(document.at("differences"),
            json({{{"key", "effects"}, {"values", {"[]", ""}}},
                  {{"key", "effects[0].type"}, {"values", {"", "drag"}}},
                  {{"key", "name"}, {"values", {"bar", "bar+drag"}}}}));
  WriteFit(folder / "bar+drag", {.name = "bar+drag", .held_out_frames = 12, .effects = {"drag"}});
  EXPECT_THAT(WhyRefused({folder / "bar", folder / "bar+drag"}),
              HasSubstr("the errors of bar and bar+drag cannot be compared"));
}

TEST(ReportDocument, APlanIsShownAsLongAsItsDiagnosisStands) {
  const TemporaryFolder folder;
  const Ledger ledger = SmallLedger();
  const std::filesystem::path run = folder / "bar";
  WriteFit(run, {});
  WriteSmallDiagnosis(run, *ledger.models[0].diagnosis);
  std::filesystem::create_directories(run / "plan");
  PlanRecord plan;
  plan.run = "bar";
  plan.diagnosis = HashFile(run / "diagnosis/diagnosis.json");
  WritePlanFile(plan, run / "plan/plan.json");
  json document = ReportDocument({run}).at("runs").at(0);
  EXPECT_EQ(document.at("models").at(0).at("plan").at("run"), "bar");
  EXPECT_THAT(document.at("notes"), IsEmpty());
  DiagnosisRecord other = *ledger.models[0].diagnosis;
  other.time_step = 0.001;
  WriteSmallDiagnosis(run, other);
  document = ReportDocument({run}).at("runs").at(0);
  EXPECT_TRUE(document.at("models").at(0).at("plan").is_null());
  EXPECT_THAT(document.at("notes").at(0).get<std::string>(),
              HasSubstr("is of an earlier diagnosis and is not shown; `lacuna plan` makes"));
}

TEST(ReportDocument, AModelWhoseAddedEffectMayBeZeroDoesNotCount) {
  const TemporaryFolder folder;
  Ledger ledger = SmallLedger();
  DiagnosisRecord diagnosis = *ledger.models[0].diagnosis;
  diagnosis.ranking[0].title = "Drag (of air)";
  diagnosis.ranking[0].sizes = {{"coefficient", "kg/m^3"}};
  WriteSmallFit(folder / "bar", {}, ledger.models[0].record);
  WriteSmallDiagnosis(folder / "bar", diagnosis);
  CalibrationRecord record = ledger.models[1].record;
  ParameterEstimate& estimate = record.parameters[1].estimate;
  const auto second = [&](double low) {
    estimate.low = low;
    estimate.high = 5;
    WriteSmallFit(folder / "bar+drag", {.name = "bar+drag", .effects = {"drag"}}, record);
    return ReportDocument({folder / "bar+drag"}).at("runs").at(0).at("models").at(1);
  };
  EXPECT_EQ(second(1).at("label"), "with drag");
  EXPECT_EQ(second(1).at("counts"), true);
  EXPECT_EQ(second(-1).at("counts"), false);
}

TEST(ReportDocument, SeriesOfPointsAreExactWhereTheNoiseIsSmall) {
  const TemporaryFolder folder;
  CalibrationRecord record = SmallLedger().models[0].record;
  const auto series = [&](double noise) {
    record.noise = noise;
    WriteSmallFit(folder / "bar", {}, record);
    return ReportDocument({folder / "bar"})
        .at("runs")
        .at(0)
        .at("models")
        .at(0)
        .at("scenes")
        .at(0)
        .at("points_series")
        .at("measured");
  };
  // The positions span 0.06 m, so that a 16-bit step is 0.9 µm.
  EXPECT_EQ(series(1e-4).at("type"), "int16");
  const json precise = series(1e-6);
  EXPECT_EQ(precise.at("type"), "float32");
  // The second marker in frame 7: 0.06, 0.002, 0.007 m.
  EXPECT_NEAR(Unpack(precise).values(3, 7), 0.06, 4e-9);
  EXPECT_NEAR(Unpack(precise).values(5, 7), 0.007, 4e-9);
}

TEST(ReportDocument, PointsWithNoiseOfTheirOwnHaveTheirSigmaInEachFrame) {
  const TemporaryFolder folder;
  const auto run = [&](const std::vector<double>& sigmas) {
    WriteFit(folder / "bar", {.sigmas = sigmas});
    return ReportDocument({folder / "bar"}).at("runs").at(0);
  };
  const json own = run({1e-4, 1e-5});
  const json& scene = own.at("models").at(0).at("scenes").at(0);
  const UnpackedArray shown = Unpack(scene.at("points").at("sigmas"));
  EXPECT_EQ(shown.shape, (std::vector<int>{3, 2}));  // the frames of the motion
  const UnpackedArray all = Unpack(scene.at("points_series").at("sigmas"));
  EXPECT_EQ(all.shape, (std::vector<int>{40, 2}));
  // Steps of the packed numbers are at most a thousandth of the smallest σ.
  EXPECT_NEAR(shown.values(0, 2), 1e-4, 1e-8);
  EXPECT_NEAR(shown.values(1, 2), 1e-5, 1e-8);
  EXPECT_NEAR(all.values(1, 39), 1e-5, 1e-8);
  // What noise gives to the rms length of a frame: in frame 3 the second marker was not seen.
  const json& noise = scene.at("series").at("noise_m");
  EXPECT_EQ(noise.size(), 40u);
  EXPECT_NEAR(noise.at(2).get<double>(), std::sqrt(3.0 * (1 + 0.01) / 2) * 1e-4, 1e-12);
  EXPECT_NEAR(noise.at(3).get<double>(), std::sqrt(3.0) * 1e-4, 1e-12);
  EXPECT_TRUE(std::isnan(all.values(1, 3)));
  // 16-bit steps of 0.9 µm are too coarse for the second marker.
  EXPECT_EQ(scene.at("points_series").at("measured").at("type"), "float32");
  EXPECT_TRUE(own.at("noise").is_null());

  // The same noise for all points is that of the fit, and the page stays as it is.
  const json equal = run({1e-4, 1e-4});
  const json& other = equal.at("models").at(0).at("scenes").at(0);
  EXPECT_FALSE(other.at("points").contains("sigmas"));
  EXPECT_FALSE(other.at("points_series").contains("sigmas"));
  EXPECT_FALSE(other.at("series").contains("noise_m"));
  EXPECT_NEAR(equal.at("noise").get<double>(), std::sqrt(3.0) * 1e-4, 1e-12);
}

// A patch is the mean of some number of scanned points, which its σ follows.
TEST(ReportDocument, NoiseOfPatchesIsAlongTheirNormals) {
  const TemporaryFolder folder;
  CalibrationRecord record = SmallLedger().models[0].record;
  record.recordings[0].scan = FittedScan{Eigen::Matrix3Xd::Zero(3, 2), 2e-5, 1};
  WriteSmallFit(folder / "bar", {.sigmas = {1e-5, 3e-5}}, record);
  const json scenes =
      ReportDocument({folder / "bar"}).at("runs").at(0).at("models").at(0).at("scenes");
  EXPECT_NEAR(scenes.at(0).at("series").at("noise_m").at(0).get<double>(), std::sqrt(5.0) * 1e-5,
              1e-12);
}

TEST(ReportDocument, CorrelationsOfAllPairsOfPointsAreLeftOut) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  const json comparison =
      ReportDocument({folder / "bar"}).at("runs").at(0).at("models").at(0).at("comparison");
  const json& space = comparison.at("recordings").at(0).at("parts").at(0).at("space_correlation");
  EXPECT_TRUE(space.contains("mean_correlation"));
  EXPECT_FALSE(space.contains("pairs"));
}

TEST(ReportDocument, SealedCasesHaveOneSentenceForEachKindOfTruth) {
  const TemporaryFolder folder;
  const auto rate = [](const char* truth, const char* what, int cases, int of) {
    return json{{"truth", truth}, {"what", what}, {"cases", cases}, {"of", of}, {"predicted", {}}};
  };
  json report = {{"tallies", json::array()},
                 {"rates",
                  {rate("nothing is missing", "an effect is named", 0, 17),
                   rate("nothing is missing", "several are named", 0, 17),
                   rate("two effects are missing", "both are named", 0, 0),
                   rate("one effect is missing", "it is named, and no other", 11, 18)}}};
  std::ofstream(folder / "report.json") << report;
  EXPECT_THAT(ReportDocument({folder.Path()}).at("sentences"),
              ElementsAre("In 0 of 17 cases in which nothing is missing, an effect is named.",
                          "In 11 of 18 cases in which one effect is missing, it is named, and no "
                          "other."));
  report["rates"][0].erase("of");
  std::ofstream(folder / "report.json") << report;
  EXPECT_THAT(WhyRefused({folder.Path()}), HasSubstr("report.json"));
}

TEST(ReportDocument, IntervalsAreShownWithHowOftenTheyHold) {
  const TemporaryFolder folder;
  json report = {{"schema_version", 1},
                 {"parameters",
                  {{{"name", "young_modulus"},
                    {"draws", 101},
                    {"covered_50", 0.5},
                    {"covered_80", 0.76},
                    {"covered_95", 0.92},
                    {"mean", -0.23},
                    {"spread", 1.04},
                    {"p_uniform", 0.28},
                    {"positions", {0.1, 0.5, 0.9}}}}}};
  std::ofstream(folder / "intervals.json") << report;
  const json document = ReportDocument({folder.Path()});
  EXPECT_THAT(document.at("sentences"),
              ElementsAre("The 95 % interval of young_modulus contains the truth in 92 % of 101 "
                          "draws."));
  EXPECT_EQ(document.at("runs").at(0).at("kind"), "intervals");
  EXPECT_EQ(document.at("runs").at(0).at("intervals"), report);
  report["parameters"][0].erase("covered_95");
  std::ofstream(folder / "intervals.json") << report;
  EXPECT_THAT(WhyRefused({folder.Path()}), HasSubstr("intervals.json"));
}

TEST(ReportDocument, ScenesHaveTheFramesOfTheMotionAndAllFramesAsSeries) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  const json scenes =
      ReportDocument({folder / "bar"}).at("runs").at(0).at("models").at(0).at("scenes");
  ASSERT_EQ(scenes.size(), 2u);
  const json& scene = scenes.at(0);
  EXPECT_EQ(scene.at("times"), json({0.0, 0.1, 0.3}));
  EXPECT_EQ(scene.at("fitted"), json({true, true, false}));
  EXPECT_EQ(scene.at("up"), json({0.0, 0.0, 1.0}));
  EXPECT_EQ(Unpack(scene.at("surface").at("positions")).shape, (std::vector<int>{3, 3, 3}));
  const UnpackedArray measured = Unpack(scene.at("points").at("measured"));
  EXPECT_EQ(measured.shape, (std::vector<int>{3, 2, 3}));
  EXPECT_NEAR(measured.values(2, 1), 0.01, 1e-6);  // frame 10
  EXPECT_NEAR(Unpack(scene.at("points").at("residual")).values(2, 1), 3e-4, 1e-8);
  EXPECT_EQ(scene.at("points").at("names"), json({"root", "tip"}));
  EXPECT_EQ(scene.at("series").at("time_s").size(), 40u);
  EXPECT_NEAR(scene.at("series").at("rms_m").at(7).get<double>(), 3e-4, 1e-12);
  EXPECT_TRUE(std::isnan(Unpack(scene.at("points_series").at("model")).values(5, 3)));
  // The second recording has no motion: its points are shown alone.
  EXPECT_TRUE(scenes.at(1).at("surface").is_null());
  EXPECT_EQ(scenes.at(1).at("times").size(), 40u);
}

// A fit with a load cell for the force along x and y and the torque about x in its first recording.
json CurvesOf(const std::filesystem::path& run, const std::string& forces) {
  CalibrationRecord record = SmallLedger().models[0].record;
  FittedReaction force, torque;
  force.name = torque.name = "jaw";
  force.labels = {"x", "y"};
  force.deviation = 0.02;
  torque.is_torque = true;
  torque.labels = {"x"};
  torque.deviation = 1e-4;
  for (FittedReaction* reaction : {&force, &torque})
    reaction->tare.assign(reaction->labels.size(), 0);
  record.recordings[0].reactions = {force, torque};
  WriteSmallFit(run, {}, record);
  const char* header = "recording,reaction,component,frame,time_s,fitted,";
  std::ofstream(run / "calibration/reactions.csv")
      << header << "displacement_m,measured_N,difference_N\n"
      << forces;
  std::ofstream(run / "calibration/torques.csv")
      << header << "rotation_rad,measured_N_m,difference_N_m\n0,1,0,0,0,1,0,0.001,0\n"
      << "0,1,0,2,2,0,0.1,0.003,-0.001\n";
  return ReportDocument({run}).at("runs").at(0).at("models").at(0).at("scenes").at(0).at(
      "reactions");
}

TEST(ReportDocument, EveryMeasuredComponentIsACurveOverTimeAndOverTheMotionOfItsGrip) {
  const TemporaryFolder folder;
  // The second component has no reading in its second frame, and the grip hardly moves along it.
  const json curves = CurvesOf(folder / "bar",
                               "0,0,0,0,0,1,0,0,0.01\n0,0,1,0,0,1,0,0.5,0\n"
                               "0,0,0,1,1,1,0.001,1,0\n0,0,1,1,1,1,0.00001,nan,nan\n"
                               "0,0,0,2,2,0,0.002,3,-0.5\n0,0,1,2,2,0,0.00002,0.25,0.5\n");
  ASSERT_EQ(curves.size(), 3u);
  EXPECT_EQ(curves.at(0), json({{"reading", 0},
                                {"grip", "jaw"},
                                {"quantity", "force"},
                                {"unit", "N"},
                                {"component", "x"},
                                {"sigma", 0.02},
                                {"time_s", {0.0, 1.0, 2.0}},
                                {"fitted", {true, true, false}},
                                {"measured", {0.0, 1.0, 3.0}},
                                {"model", {0.01, 1.0, 2.5}},
                                {"motion", {0.0, 0.001, 0.002}}}));
  EXPECT_EQ(curves.at(1).at("component"), "y");
  EXPECT_EQ(curves.at(1).at("time_s"), json({0.0, 2.0}));
  EXPECT_EQ(curves.at(1).at("model"), json({0.5, 0.75}));
  EXPECT_TRUE(curves.at(1).at("motion").is_null());
  EXPECT_EQ(curves.at(2).at("quantity"), "torque");
  EXPECT_EQ(curves.at(2).at("unit"), "N m");
  EXPECT_EQ(curves.at(2).at("fitted"), json({true, false}));
  EXPECT_EQ(curves.at(2).at("motion"), json({0.0, 0.1}));
}

TEST(ReportDocument, RefusesReactionsThatTheFitDoesNotHave) {
  const TemporaryFolder folder;
  try {
    CurvesOf(folder / "bar", "0,0,2,0,0,1,0,0,0.01\n");
    FAIL() << "nothing was refused";
  } catch (const InputError& problem) {
    EXPECT_THAT(problem.what(), HasSubstr("component 2 of reading 0 of a"));
  }
}

TEST(ReportDocument, WhatIsOfAnEarlierFitIsLeftOutWithANote) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  std::filesystem::remove(folder / "bar/ledger.json");
  CalibrationRecord other = SmallLedger().models[0].record;
  other.rms = 7;
  WriteSmallFit(folder / "other", {}, other);
  std::filesystem::copy(folder / "bar/comparison", folder / "other/comparison");
  std::filesystem::copy(folder / "bar/diagnosis", folder / "other/diagnosis");
  std::filesystem::copy(
      folder / "bar/shown_motion", folder / "other/shown_motion",
      std::filesystem::copy_options::recursive | std::filesystem::copy_options::overwrite_existing);
  const json run = ReportDocument({folder / "other"}).at("runs").at(0);
  const json& model = run.at("models").at(0);
  EXPECT_TRUE(model.at("comparison").is_null());
  EXPECT_TRUE(model.at("diagnosis").is_null());
  EXPECT_TRUE(model.at("scenes").at(0).at("surface").is_null());
  const std::vector<std::string> notes = run.at("notes");
  EXPECT_THAT(notes, ElementsAre(HasSubstr("comparison"), HasSubstr("diagnosis")));
}

TEST(ReportDocument, ALedgerOfOtherFitsIsLeftOut) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  CalibrationRecord changed = SmallLedger().models[0].record;
  changed.recordings[0].held_out.rms = 9e-4;
  WriteSmallFit(folder / "bar", {}, changed);
  const json run = ReportDocument({folder / "bar"}).at("runs").at(0);
  EXPECT_TRUE(run.at("ledger").is_null());
  EXPECT_EQ(run.at("models").size(), 1u);
  EXPECT_THAT(run.at("notes").at(0).get<std::string>(), HasSubstr("ledger"));
}

TEST(ReportDocument, AnAddedModelOfAnotherVersionIsLeftOut) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  const std::filesystem::path file = folder / "bar+drag/calibration/calibration.json";
  json calibration = ReadJsonFile(file);
  calibration["schema_version"] = 1;
  std::ofstream(file) << calibration;
  const std::filesystem::path manifest_file = folder / "bar+drag/manifest.json";
  Manifest manifest = LoadManifest(manifest_file);
  for (StoredFile& stored : manifest.stages.at("calibration").files) {
    if (stored.name != "calibration.json") continue;
    stored.size = std::filesystem::file_size(file);
    stored.hash = HashFile(file);
  }
  SaveManifest(manifest, manifest_file);
  const json run = ReportDocument({folder / "bar"}).at("runs").at(0);
  EXPECT_EQ(run.at("models").size(), 1u);
  EXPECT_THAT(run.at("notes").at(0).get<std::string>(), HasSubstr("ledger"));
}

TEST(ReportDocument, TwoRunsAreComparedByTheirConfigurations) {
  const TemporaryFolder folder;
  WriteFit(folder / "soft", {.name = "soft", .young_modulus = 1e5});
  WriteFit(folder / "stiff", {.name = "stiff", .young_modulus = 2e5});
  const json document = ReportDocument({folder / "soft", folder / "stiff"});
  EXPECT_EQ(document.at("title"), "soft, stiff");
  EXPECT_EQ(document.at("runs").size(), 2u);
  EXPECT_EQ(document.at("differences"),
            json({{{"key", "material.young_modulus"}, {"values", {"100000", "200000"}}},
                  {{"key", "name"}, {"values", {"soft", "stiff"}}}}));
  EXPECT_THAT(document.at("sentences").at(0).get<std::string>(), HasSubstr("soft: The model"));
}

TEST(ReportDocument, RefusesErrorsThatCannotBeCompared) {
  const TemporaryFolder folder;
  WriteFit(folder / "a", {.name = "a"});
  WriteFit(folder / "longer", {.name = "longer", .held_out_frames = 12});
  WriteFit(folder / "other", {.name = "other", .content = "another recording"});
  EXPECT_THAT(WhyRefused({folder / "a", folder / "longer"}),
              HasSubstr("the errors of a and longer cannot be compared: a with 30 fitted and 10 "
                        "held-out frames of markers, and a with 30 fitted and 12"));
  EXPECT_THAT(WhyRefused({folder / "a", folder / "other"}),
              HasSubstr("the content of a/markers.csv is not the same"));
}

TEST(ReportDocument, RefusesWhatIsNoRun) {
  const TemporaryFolder folder;
  EXPECT_THAT(WhyRefused({folder / "absent"}), HasSubstr("there is no such folder"));
  EXPECT_THAT(WhyRefused({folder.Path()}), HasSubstr("is not a run"));
  WriteFit(folder / "a", {});
  std::ofstream(folder / "a/calibration/calibration.json", std::ios::app) << "\n";
  EXPECT_THAT(WhyRefused({folder / "a"}), HasSubstr("calibration.json"));
}

TEST(ReportDocument, WithoutPackedArraysIsSmallAndHasTheNumbers) {
  const TemporaryFolder folder;
  WriteSmallChain(folder.Path());
  const json document = WithoutPackedArrays(ReportDocument({folder / "bar"}));
  EXPECT_THAT(document.dump(), testing::Not(HasSubstr("base64")));
  const json& scene = document.at("runs").at(0).at("models").at(0).at("scenes").at(0);
  EXPECT_EQ(scene.at("series").at("rms_m").size(), 40u);
  EXPECT_FALSE(scene.at("points").contains("measured"));
}

}  // namespace
}  // namespace lacuna
