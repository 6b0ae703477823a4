// A slow experiment: a bar that is loaded and unloaded in steps, in equilibrium in every frame.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <random>
#include <sstream>
#include <utility>
#include <variant>

#include "calibration/adaptive_time_step.h"
#include "calibration/calibration_fits.h"
#include "diagnosis/diagnosis.h"
#include "diagnosis/grip_motions.h"
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/rank_effects.h"
#include "diagnosis/recorded_diagnosis.h"
#include "diagnosis/thresholds.h"
#include "effects/catalogue.h"
#include "fem/prescribed_force.h"
#include "fem/stepper.h"
#include "geometry/embedding.h"
#include "prediction/prediction_study_reader.h"
#include "report/verdict_text.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

constexpr int kLoads = 16;        // frames, one a second
constexpr double kModulus = 9e4;  // Pa
constexpr double kRatio = 0.42;
constexpr double kNoise = 2e-5;    // m
constexpr double kFilmStep = 0.1;  // s

// N, along z: up in 4 s, then held, half of it from 10 s on.
double LoadAt(double time) {
  if (time < 4) return -0.02 * time;
  if (time < 9) return -0.08;
  return -0.08 + 0.04 * std::min(1.0, time - 9);
}

// Markers of the bar; its material besides what is hidden is neo-Hookean.
std::vector<Eigen::Matrix3Xd> Film(const std::vector<std::shared_ptr<const Effect>>& hidden) {
  Model model;
  model.body = std::make_shared<const Body>(MakeBody(BarMesh({10, 3, 3}, 2), 1000));
  const TetMesh& mesh = model.body->mesh;
  model.effects = {
      MakeEffect("neo_hookean", {{"young_modulus", kModulus}, {"poisson_ratio", kRatio}}),
      MakeEffect("gravity", {{"acceleration_z", -9.80665}})};
  model.effects.insert(model.effects.end(), hidden.begin(), hidden.end());
  model.grips = {{NodesWhere(mesh, [](const Eigen::Vector3d& at) { return at.x() < 0.002; }), {}}};
  const Eigen::VectorXd share = BoundaryShares(
      *model.body, NodesWhere(mesh, [](const Eigen::Vector3d& at) { return at.x() > 0.078; }));
  Stepper stepper(model, {.scheme = TimeScheme::kQuasiStatic});
  MotionHistory history = RestHistory(model);
  EXPECT_TRUE(stepper.Equilibrium({}, &history).IsUsable());
  const Embedding places = Embed(mesh, BarMarkerPlaces());
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, kNoise);
  std::vector<Eigen::Matrix3Xd> markers;
  const int of_second = static_cast<int>(std::lround(1 / kFilmStep));
  for (int step = 0; step <= (kLoads - 1) * of_second; ++step) {
    if (step > 0) {
      Eigen::VectorXd force = Eigen::VectorXd::Zero(3 * share.size());
      for (Eigen::Index i = 0; i < share.size(); ++i)
        force[3 * i + 2] = share[i] * LoadAt(kFilmStep * step);
      EXPECT_TRUE(stepper.Step(kFilmStep, force, &history).IsUsable());
    }
    if (step % of_second != 0) continue;
    markers.push_back(PointsAt(places, mesh, history.position.reshaped(3, mesh.NodeCount())));
    for (double& coordinate : markers.back().reshaped()) coordinate += noise(random);
  }
  return markers;
}

class LoadedBar : public testing::Test {
 protected:
  // `reading`: of the load cell, per newton.
  PredictionStudy Record(const std::vector<std::shared_ptr<const Effect>>& hidden,
                         const std::string& more = "", const std::string& effects = "",
                         double reading = 1) {
    WriteBarRecording(folder_.Path(), Film(hidden));
    std::ofstream load(folder_ / "load.csv");
    load << "t,x,y,z\n";
    for (int k = 0; k < kLoads; ++k) load << fmt::format("{},0,0,{}\n", k, reading * LoadAt(k));
    load.close();
    std::ofstream(folder_ / "recording.yaml", std::ios::app) << R"(forces:
  - name: load
    file: load.csv
    time: t
    x: x
    y: y
    z: z
    unit: N
    region: {half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}
)";
    // A frame a second.
    std::string text = FileContent(folder_ / "markers.csv");
    std::ofstream csv(folder_ / "markers.csv");
    std::istringstream lines(text);
    std::string line;
    for (int row = -1; std::getline(lines, line); ++row)
      csv << (row < 0 ? line : fmt::format("{}{}", row, line.substr(line.find(',')))) << '\n';
    csv.close();
    return Experiment(more, effects);
  }

  // `effects`: of the model, besides gravity, each after a comma.
  PredictionStudy Experiment(const std::string& more, const std::string& effects = "") const {
    return ReadPredictionStudy(
        Config::Parse(fmt::format(R"(schema_version: 1
name: loaded bar
mesh: {{max_volume: 1000 mm^3, order: 2}}
material: {{law: neo_hookean, young_modulus: 0.15 MPa, poisson_ratio: 0.4}}
effects: [{{type: gravity, acceleration: [0, 0, -9.80665 m/s^2]}}{}]
motion: {{scheme: quasi_static}}
noise: 0.02 mm
place_deviation: 0.1 mm
{}recordings: [{{recording: {}, fit_until: 11 s}}]
)",
                                  effects, more, (folder_ / "recording.yaml").string()),
                      (folder_ / "study.yaml").string()));
  }

  // With two refits, on a coarse mesh.
  Diagnosis FitAndDiagnose(PredictionStudy* study) {
    const TetMesh mesh = BarMesh({7, 1, 1}, 2);
    const AdaptedFit fit = FitWithAdaptiveTimeStep(mesh, study, &progress_);
    EXPECT_TRUE(fit.calibration.usable) << fit.calibration.message;
    const CalibrationProblem problem(*study, mesh);
    DiagnosisOptions options;
    options.refits = 2;
    return Diagnose(problem, fit.calibration.parameters, options, &progress_);
  }

  TemporaryFolder folder_;
  SilentProgress progress_;
};

TEST_F(LoadedBar, IsFittedInAStepAFrame) {
  PredictionStudy study = Record({});
  EXPECT_EQ(study.time_step, 1);
  const AdaptedFit fit = FitWithAdaptiveTimeStep(BarMesh({7, 2, 2}, 2), &study, &progress_);
  ASSERT_TRUE(fit.calibration.usable) << fit.calibration.message;
  EXPECT_EQ(study.time_step, 1);  // nothing depends on rates
  EXPECT_LT(fit.step_error, 0.01);
  EXPECT_NEAR(fit.calibration.parameters[0], kModulus, 0.02 * kModulus);
  EXPECT_NEAR(fit.calibration.parameters[1], kRatio, 0.05);
  EXPECT_LT(fit.calibration.rms, 1.2);
}

std::shared_ptr<const Effect> BedBelow() {
  return MakeEffect("elastic_support", {{"modulus", 1.5e5},
                                        {"side_z", -1},
                                        {"point_x", 0.047},
                                        {"point_z", -0.01},
                                        {"radius", 0.009}});
}

// A bed under a part of the bar, whose modulus, place and size are fitted on another mesh.
TEST_F(LoadedBar, RecoversAPartlySupportedSide) {
  PredictionStudy study = Record(
      {BedBelow()},
      "fit: {parameters: [{name: young_modulus}, {name: elastic_support.modulus}, "
      "{name: elastic_support.point_x, min: 0 m, max: 0.08 m}, {name: elastic_support.radius, "
      "min: 3 mm, max: 40 mm}]}\n",
      ", {type: elastic_support, modulus: 30 kPa/m, side: [0, 0, -1], point: [35 mm, 0 m, -10 mm], "
      "radius: 15 mm}");
  const AdaptedFit fit = FitWithAdaptiveTimeStep(BarMesh({7, 2, 2}, 2), &study, &progress_);
  ASSERT_TRUE(fit.calibration.usable) << fit.calibration.message;
  EXPECT_LT(fit.calibration.rms, 1.3);
  const Eigen::VectorXd& found = fit.calibration.parameters;
  EXPECT_NEAR(found[0], kModulus, 0.03 * kModulus);
  // Modulus times the square of the radius is what a bed this short is known by.
  EXPECT_NEAR(found[1] * found[3], 1.5e5 * 0.009, 0.1 * 1.5e5 * 0.009);
  // The place and the radius trade off (the correlation is 0.97): the interval of the place is 28
  // mm wide.
  EXPECT_NEAR(found[2], 0.047, 0.006);
  for (const auto& [k, truth] : {std::pair(2, 0.047), std::pair(3, 0.009)}) {
    EXPECT_LT(fit.calibration.estimates[k].low, truth) << k;
    EXPECT_GT(fit.calibration.estimates[k].high, truth) << k;
  }
}

// First order alone finds the side and about the place.
TEST_F(LoadedBar, TriesASupportOnEachSide) {
  PredictionStudy study = Record({BedBelow()});
  const TetMesh mesh = BarMesh({7, 1, 1}, 2);
  const AdaptedFit fit = FitWithAdaptiveTimeStep(mesh, &study, &progress_);
  ASSERT_TRUE(fit.calibration.usable) << fit.calibration.message;
  const CalibrationProblem problem(study, mesh);
  const EffectRanking ranking =
      RankEffects(problem, fit.calibration.parameters, &progress_, {}, {});
  const auto support = std::find_if(
      ranking.effects.begin(), ranking.effects.end(),
      [](const ScoredEffect& effect) { return effect.candidate.type == "elastic_support"; });
  ASSERT_NE(support, ranking.effects.end());
  EXPECT_THAT(support->candidate.variant, testing::StartsWith("on the −z side"));
  EXPECT_GT(support->score.evidence, 20);
}

// Eight states of one bar tell nearly as much in recordings of one frame each as in one recording,
// because the markers stay where they are on the bar. (Each recording has nuisances of its own.)
// Markers that were put on anew have other names, and errors of their own, which hide the bed where
// the places are known to 1 mm only.
TEST_F(LoadedBar, TellsMoreWhereRecordingsShareMarkers) {
  PredictionStudy together = Record({BedBelow()});
  together.place_deviation = 1e-3;
  together.recordings.front().fit_until = 20;
  together.recordings.front().frames = {1, 3, 5, 7, 9, 11, 13, 15};
  PredictionStudy apart = together;
  apart.recordings.clear();
  for (const int frame : together.recordings.front().frames) {
    PredictedRecording& one = apart.recordings.emplace_back(together.recordings.front());
    one.frames = {frame};
    one.name = fmt::format("frame {}", frame);
  }
  PredictionStudy renamed = apart;
  for (PredictedRecording& one : renamed.recordings)
    for (std::string& marker : one.recording.markers.names) marker += " in " + one.name;
  const TetMesh mesh = BarMesh({7, 1, 1}, 2);
  const auto evidence = [&](PredictionStudy* study) {
    const AdaptedFit fit = FitWithAdaptiveTimeStep(mesh, study, &progress_);
    EXPECT_TRUE(fit.calibration.usable) << fit.calibration.message;
    const CalibrationProblem problem(*study, mesh);
    return RankEffects(problem, fit.calibration.parameters, &progress_, {}, {})
        .Find("elastic_support")
        ->score.evidence;
  };
  const double in_one = evidence(&together);
  EXPECT_GT(in_one, 30);
  EXPECT_GT(evidence(&apart), 0.6 * in_one);
  EXPECT_LT(evidence(&renamed), 0.3 * in_one);
}

// A strain without stress, which the moduli of the model do not change: both are found.
TEST_F(LoadedBar, RecoversASwellingAndPoissonsRatio) {
  PredictionStudy study = Record({MakeEffect("swelling", {{"strain", 0.03}})},
                                 "fit: {parameters: [{name: young_modulus}, {name: poisson_ratio}, "
                                 "{name: swelling.strain}]}\n",
                                 ", {type: swelling, strain: 0}");
  const AdaptedFit fit = FitWithAdaptiveTimeStep(BarMesh({7, 2, 2}, 2), &study, &progress_);
  ASSERT_TRUE(fit.calibration.usable) << fit.calibration.message;
  EXPECT_LT(fit.calibration.rms, 1.3);
  EXPECT_NEAR(fit.calibration.parameters[0], kModulus, 0.03 * kModulus);
  // Bending shows Poisson's ratio no better without the swelling (IsFittedInAStepAFrame).
  EXPECT_NEAR(fit.calibration.parameters[1], kRatio, 0.05);
  EXPECT_NEAR(fit.calibration.parameters[2], 0.03, 0.0005);
  const ParameterEstimate& strain = fit.calibration.estimates[2];
  EXPECT_LT(std::abs(strain.correlation), 0.5) << "independent of the moduli";
  EXPECT_LT(strain.high - strain.low, 0.004);
}

// Points of an image correlation are as good as markers.
TEST_F(LoadedBar, ComesAsTrackedPointsToo) {
  Record({});
  for (int k = 0; k < kLoads; ++k) {
    std::ofstream points(folder_ / fmt::format("points_{:02}.csv", k));
    points << "x,y,z\n";
    const Eigen::Matrix3Xd places = BarMarkerPlaces().array() + 1e-3 * k;
    for (const auto& point : places.colwise())
      points << fmt::format("{},{},{}\n", point.x(), point.y(), point.z());
    points << (k == 5 ? "nan,nan,nan\n" : "0.04,0.01,0\n");  // lost in one frame
  }
  std::string text = FileContent(folder_ / "recording.yaml");
  const size_t frames = text.find("frames:"), fixed = text.find("fixed:");
  text.replace(frames, fixed - frames,
               "frames: {kind: points, pattern: points_%02d.csv, count: 16, rate: 1 Hz, "
               "tracked: true, columns: {x: x, y: y, z: z}}\n");
  text.replace(text.find("fixed: [{name"), 13, "gripped: [{follows: scan, name");
  std::ofstream(folder_ / "recording.yaml") << text;
  EXPECT_THAT([&] { Experiment(""); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr("region \"clamp\"")));
  text.replace(text.find("point: [0.002 m"), 15, "point: [0.025 m");
  std::ofstream(folder_ / "recording.yaml") << text;
  const PredictionStudy study = Experiment("");
  const PredictedRecording& item = study.recordings[0];
  EXPECT_EQ(item.scans, nullptr);
  ASSERT_EQ(item.recording.markers.names.size(), 9u);
  EXPECT_EQ(item.recording.markers.names[8], "p8");
  EXPECT_TRUE(item.recording.markers.places.leftCols(8).isApprox(BarMarkerPlaces(), 1e-9));
  EXPECT_TRUE(item.recording.markers.positions[5].col(8).array().isNaN().all());
  EXPECT_EQ(item.recording.markers.positions[4](0, 8), 0.04);
  EXPECT_EQ(item.recording.object.grips[0].motion, GripMotion::kFollowsMarkers);
  EXPECT_EQ(PlaceDeviation(study, item, 2e-5), 1e-4) << "given in the experiment";
  PredictionStudy without = study;
  without.place_deviation_is_given = false;
  EXPECT_EQ(PlaceDeviation(without, item, 2e-5), 2e-5) << "the noise of the frame that shows them";
  EXPECT_THAT(item.recording.object.grips[0].markers, testing::ElementsAre("p0", "p1"));
}

TEST_F(LoadedBar, TellsThatItCreeps) {
  PredictionStudy study =
      Record({MakeEffect("viscoelastic_branch",
                         {{"modulus", 4e4}, {"relaxation_time", 2.5}, {"poisson_ratio", kRatio}})});
  const Diagnosis diagnosis = FitAndDiagnose(&study);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << ExplainVerdict(RecordOf(diagnosis));
  EXPECT_THAT(diagnosis.effects, testing::ElementsAre("viscoelastic_branch"));
  for (const RankedEffect& effect : diagnosis.ranking) {
    if (effect.scored.candidate.type != "viscoelastic_branch") continue;
    ASSERT_EQ(effect.others.size(), 1u);
    EXPECT_EQ(effect.others[0].name, "viscoelastic_branch.relaxation_time");
    EXPECT_EQ(effect.others[0].unit, "s");
    EXPECT_NEAR(effect.others[0].estimate.value, 2.5, 0.5);
    EXPECT_NEAR(effect.sizes.at(0).value, 4e4, 0.6e4);
  }
}

// The bar bends so far that the response to its load is not linear. To first order a wrong load
// explains less than it does, and an effect that is fitted would be taken for it.
TEST_F(LoadedBar, BendsAsUnderTheLoadThatItReallyBears) {
  PredictionStudy study = Record({}, "", "", /*reading=*/1.4);
  const Diagnosis diagnosis = FitAndDiagnose(&study);
  EXPECT_THAT(diagnosis.effects, testing::Contains("load_scale"))
      << ExplainVerdict(RecordOf(diagnosis));
  const auto scale = std::find_if(
      diagnosis.nuisances.begin(), diagnosis.nuisances.end(),
      [](const ScoredNuisance& nuisance) { return nuisance.candidate.card.name == "load_scale"; });
  ASSERT_NE(scale, diagnosis.nuisances.end());
  ASSERT_TRUE(scale->refitted.has_value());
  EXPECT_GT(*scale->refitted, scale->evidence + 2);
  for (const RankedEffect& effect : diagnosis.ranking)
    EXPECT_GT(*scale->refitted, effect.evidence) << effect.scored.candidate.type;
}

// A bar is stretched uniformly by two grips, whose motion is known from noisy markers. The nuisance
// is as large as the error that this noise causes in the predicted motion between the grips.
TEST_F(LoadedBar, HasAGripJitterOfTheSizeOfTheMarkersNoise) {
  WriteBox(folder_ / "box.off");
  std::vector<Eigen::Vector3d> places;
  for (const double x : {0.0, 0.08, 0.02, 0.03, 0.04, 0.05, 0.06})
    for (const double y : {-0.01, 0.01})
      for (const double z : {-0.01, 0.01}) places.emplace_back(x, y, z);
  std::ofstream yaml(folder_ / "recording.yaml");
  yaml << "schema_version: 1\nname: stretched\nlength_unit: m\ndensity: 1000 kg/m^3\nframes:\n"
          "  kind: markers\n  file: markers.csv\n  columns: {time: t}\n  marker_places:\n";
  std::ofstream csv(folder_ / "markers.csv");
  csv << "t";
  for (size_t m = 0; m < places.size(); ++m) {
    yaml << fmt::format("    - {{name: m{}, position: [{} m, {} m, {} m]}}\n", m, places[m].x(),
                        places[m].y(), places[m].z());
    csv << fmt::format(",m{0}_x,m{0}_y,m{0}_z", m);
  }
  yaml << R"(reference: {from: mesh, file: box.off}
gripped:
  - {half_space: {point: [0.1 mm, 0 m, 0 m], normal: [-1, 0, 0]}, follows_markers: [m0, m1, m2, m3], deforms: true}
  - {half_space: {point: [79.9 mm, 0 m, 0 m], normal: [1, 0, 0]}, follows_markers: [m4, m5, m6, m7], deforms: true}
)";
  yaml.close();
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, kNoise);
  for (int frame = 0; frame < 21; ++frame) {
    const double stretch = 0.001 * frame;
    csv << fmt::format("\n{}", frame);
    for (size_t m = 0; m < places.size(); ++m) {
      const double error = m < 8 ? 1 : 0;  // of the grips' markers alone
      csv << fmt::format(",{},{},{}", (1 + stretch) * places[m].x() + error * noise(random),
                         (1 - kRatio * stretch) * places[m].y() + error * noise(random),
                         (1 - kRatio * stretch) * places[m].z() + error * noise(random));
    }
  }
  csv << "\n";
  csv.close();
  const PredictionStudy study = ReadPredictionStudy(Config::Parse(
      fmt::format(
          "schema_version: 1\nname: stretched\nmesh: {{max_volume: 1000 mm^3, order: 2}}\n"
          "material: {{law: corotational, young_modulus: 0.1 MPa, poisson_ratio: 0.42}}\n"
          "motion: {{scheme: quasi_static}}\nnoise: {} m\nplace_deviation: 0.1 mm\n"
          "fit: {{parameters: [{{name: poisson_ratio}}]}}\nrecordings: [{{recording: {}}}]\n",
          kNoise, (folder_ / "recording.yaml").string()),
      (folder_ / "study.yaml").string()));
  const CalibrationProblem problem(study, BarMesh({7, 1, 1}, 2));
  const Eigen::VectorXd start = problem.Start();
  const LinearisedWithGrips linearised = LineariseWithGrips(problem, start, {});
  const GripMotions& grips = linearised.grips;
  const LinearisedMisfit& misfit = linearised.misfit;
  ASSERT_TRUE(misfit.usable) << misfit.message;
  const Eigen::MatrixXd grip_columns = linearised.OfGrips();
  const std::vector<NuisanceCandidate> nuisances =
      ModelNuisances({problem, start, misfit, grips, grip_columns});
  const auto jitter = std::find_if(nuisances.begin(), nuisances.end(), [](const auto& nuisance) {
    return nuisance.card.name == "grip_jitter";
  });
  ASSERT_NE(jitter, nuisances.end());
  EXPECT_EQ(jitter->columns.cols(), 21 * 2 * (3 + 6));
  double seen = 0, expected = 0;
  const Eigen::Index series = 3 * static_cast<Eigen::Index>(places.size());
  for (Eigen::Index row = 0; row < misfit.residual.size(); ++row) {
    if (row % series < 3 * 8) continue;
    seen += misfit.residual[row] * misfit.residual[row];
    expected += jitter->columns.row(row).squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(seen / expected), 1, 0.25);
  EXPECT_TRUE(jitter->left_out.empty());

  // With too many frames for a column each, the recording is named instead.
  LinearisedMisfit many = misfit;
  many.parts.front().layout.times.resize(kThresholds.nuisances.most_single_frames + 1);
  // With too many rows for the columns of all frames, it says how much memory these would need.
  LinearisedMisfit large = misfit;
  large.residual.resize(500'000);
  for (const NuisanceEntry& entry : NuisanceCatalogue()) {
    if (entry.card.name != "grip_jitter") continue;
    const auto make = [&](const LinearisedMisfit& along) {
      return std::get<ModelNuisance>(entry.make)({problem, start, along, grips, grip_columns});
    };
    const std::optional<NuisanceCandidate> of_many = make(many), of_large = make(large);
    ASSERT_TRUE(of_many.has_value() && of_large.has_value());
    EXPECT_EQ(of_many->columns.cols(), 0);
    EXPECT_THAT(of_many->left_out, testing::ElementsAre(study.recordings.front().name));
    EXPECT_EQ(of_large->columns.cols(), 0);
    EXPECT_THAT(of_large->untried, testing::HasSubstr("1.5 GB"));
  }
}

}  // namespace
}  // namespace lacuna
