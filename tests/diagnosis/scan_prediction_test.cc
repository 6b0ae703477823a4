// Scans as the data of a prediction study.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "calibration/calibration_problem.h"
#include "calibration/calibration_run.h"
#include "calibration/held_out_misfit.h"
#include "comparison/run_comparison.h"
#include "core/parallel.h"
#include "diagnosis/effect_refit.h"
#include "prediction/prediction_study_reader.h"
#include "report/comparison_report.h"
#include "support/replace_in_file.h"
#include "support/scanned_bar.h"
#include "support/silent_fit.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::HasSubstr;

constexpr char kClampedEnd[] =
    "fixed: [{name: clamp, half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}}]\n";
constexpr char kShape[] = "reference: {from: mesh, file: box.off}\n";
// Fits the frames up to 0.2 s, and begins with twice the damping of the truth.
const std::map<std::string, std::string> kUntil{{"fit_until: 0.1501", "fit_until: 0.2001"},
                                                {"alpha: 1 1/s", "alpha: 4 1/s"}};

const std::vector<TriMesh>& HeldSurfaces() {
  static const std::vector<TriMesh> surfaces = HeldBarSurfaces({});
  return surfaces;
}

std::string MessageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& problem) {
    return problem.what();
  }
  return "nothing was refused";
}

// A nuisance is given as a change of the misfit, patch by patch: a refit must look at the same
// patches, though its model is another problem.
TEST(ScanPrediction, ARefitTakesAwayWhatANuisanceExplains) {
  const TemporaryFolder folder;
  WriteBarScans(folder.Path(), HeldSurfaces(), std::string(kClampedEnd) + kShape);
  const PredictionStudy study = ReadBarStudy(folder.Path(), kUntil);
  const CalibrationProblem problem(study, BarMesh({6, 2, 2}, 1));
  const Eigen::VectorXd start = problem.Start();
  const LinearisedMisfit misfit = problem.Linearise(start, {.with_jacobian = true});
  ASSERT_TRUE(misfit.usable) << misfit.message;
  EXPECT_GT(RootMeanSquare(problem.Predict(start, false)), 5);
  const AdoptedNuisances all_of_it{misfit.residual, {{0, 1, false}}, 0};
  SilentProgress progress;
  const EffectRefit refit = Refit({{problem, start, misfit, &progress}, all_of_it}, nullptr);
  ASSERT_TRUE(refit.message.empty()) << refit.message;
  EXPECT_LT(refit.calibration.rms, 1);
  EXPECT_NEAR(refit.nuisance_amounts[0], -1, 0.05);
}

TEST(ScanPrediction, RecoversWhatWasScanned) {
  const TemporaryFolder folder;
  const HeldBarTruth truth;
  WriteBarScans(folder.Path(), HeldSurfaces(), std::string(kClampedEnd) + kShape);
  std::map<std::string, std::string> replaced = kUntil;
  replaced["motion: {time_step: 1.5 ms}"] = "motion: {time_step: 2 ms}";
  const PredictionStudy study = ReadBarStudy(folder.Path(), replaced);
  const CalibrationProblem problem(study, BarMesh({8, 2, 2}, 2));
  EXPECT_EQ(problem.noise(), 0);  // there are no markers
  // Obliquely seen faces are measured better along their normal than along the ray, those near an
  // edge are no planes.
  EXPECT_NEAR(problem.scan_noise(), kScanNoise, 0.3 * kScanNoise);
  const Calibration fit = FitSilently(problem);
  ASSERT_TRUE(fit.usable) << fit.message;
  EXPECT_GT(fit.start_rms, 10 * fit.rms);
  // Patches that only noise parts from the model; the estimate of the noise is a fifth too large.
  EXPECT_LT(fit.rms, 1.1);
  const ParameterEstimate &modulus = fit.estimates[0], &alpha = fit.estimates[1];
  // The coarser mesh is stiffer.
  EXPECT_NEAR(modulus.value, truth.young_modulus, 0.02 * truth.young_modulus);
  EXPECT_LT(modulus.low, truth.young_modulus);
  EXPECT_GT(modulus.high, truth.young_modulus);
  EXPECT_LT(modulus.high - modulus.low, 0.03 * truth.young_modulus);
  EXPECT_LT(alpha.low, truth.alpha);
  EXPECT_GT(alpha.high, truth.alpha);
  EXPECT_LT(alpha.high - alpha.low, truth.alpha / 2);

  const RecordingMisfit misfit = MisfitsOf(problem, fit.parameters)[0];
  EXPECT_EQ(misfit.in_fit.frames, 11);  // 0 to 0.2 s
  EXPECT_EQ(misfit.held_out.frames, kScans - 11);
  // All patches but some at the clamped end's edges are seen by the four cameras.
  EXPECT_GT(misfit.held_out.points, 0.95 * 150 * (kScans - 11));
  EXPECT_LT(misfit.in_fit.rms_over_sigma, 1.1);
  // The discretisation shows later on, by half as much as the noise of a patch.
  EXPECT_LT(misfit.held_out.rms_over_sigma, 1.5);
  EXPECT_TRUE(problem.models()[0].LostFrames(misfit.misfit, 0.95).empty());
}

// With correspondences kept, rows are linear in the nodes' positions, so that those of the
// derivative agree with central differences.
TEST(ScanPrediction, DerivativeAgreesWithDifferences) {
  const TemporaryFolder folder;
  WriteBarScans(folder.Path(), HeldSurfaces(), std::string(kClampedEnd) + kShape);
  const PredictionStudy study = ReadBarStudy(folder.Path(), kUntil);
  const CalibrationProblem problem(study, BarMesh({4, 1, 1}, 2));
  const std::vector<int> frames{0, 3, 4, 5, 6};
  Eigen::VectorXd at(6);
  at << 1e5, 2, 0.01, 0.04, 0.02, 0.001;
  const RecordingModel model = problem.ModelAt(0, at);
  std::vector<MisfitDirection> directions;
  for (const ModelParameter& parameter : study.fitted) {
    const auto [effect, index] = parameter.places[0];
    directions.push_back(
        {.perturbation = {.effect = model.model().effects[effect], .parameter = index}});
  }
  for (const auto& nuisance : model.nuisances()) directions.push_back(nuisance.direction);
  const Misfit here = model.Predict(frames, at.tail(4), directions);
  const auto predict = [&](const Eigen::VectorXd& values) {
    return problem.ModelAt(0, values)
        .Predict(frames, values.tail(4), {}, {.observed = &here.observed})
        .residual;
  };
  ASSERT_TRUE(here.summary.IsUsable()) << here.summary.message;
  const Eigen::VectorXd steps =
      (Eigen::VectorXd(6) << 200, 1e-2, 2e-3, 2e-3, 2e-3, 1e-4).finished();
  for (Eigen::Index k = 0; k < at.size(); ++k) {
    const Eigen::VectorXd shift = steps[k] * Eigen::VectorXd::Unit(at.size(), k);
    const Eigen::VectorXd difference = (predict(at + shift) - predict(at - shift)) / (2 * steps[k]);
    // Truncation, and trajectories that are known to 1e-8 of the forces only.
    EXPECT_LT((here.jacobian.col(k) - difference).norm(), 2e-3 * difference.norm()) << k;
    EXPECT_GT(difference.norm(), 0) << k;
  }
}

// The points of depth images are matched with the surface in parallel. What a scan says must not
// depend on how they were divided among the threads.
TEST(ScanPrediction, IsTheSameForAnyNumberOfThreads) {
  const TemporaryFolder folder;
  WriteBarScans(folder.Path(), HeldSurfaces(), std::string(kClampedEnd) + kShape, WriteDepthFrames);
  const int threads = ThreadCount();
  std::vector<Observed> observed;
  for (const int count : {1, 2}) {
    SetThreadCount(count);
    const PredictionStudy study = ReadBarStudy(folder.Path(), kUntil);
    const CalibrationProblem problem(study, BarMesh({4, 1, 1}, 2));
    const Eigen::VectorXd rest = problem.body()->mesh.nodes.reshaped();
    observed.push_back(problem.models()[0].observer().Observe(7, rest));
  }
  SetThreadCount(threads);
  EXPECT_GT(observed[0].used, 0.5 * observed[0].offered);  // of a bar that has swung away
  EXPECT_EQ(observed[0].target, observed[1].target);
  EXPECT_EQ(observed[0].count, observed[1].count);
  EXPECT_EQ(observed[0].rows->column, observed[1].rows->column);
  EXPECT_EQ(observed[0].rows->weight, observed[1].rows->weight);
}

TEST(ScanPrediction, GoesTogetherWithMarkers) {
  const TemporaryFolder folder;
  const HeldBarTruth truth;
  WriteBarRecording(folder.Path(), FilmHeldBar(truth));
  WriteBarScans(folder / "scans", HeldSurfaces(), std::string(kClampedEnd) + kShape);
  const PredictionStudy study = ReadBarStudy(
      folder.Path(), {{"recordings:\n",
                       "recordings:\n  - recording: scans/recording.yaml\n    name: scanned\n"
                       "    fit_until: 0.1001 s\n    hold:\n      region: {half_space: {point: "
                       "[0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}\n      release: 0.0437 s\n"},
                      {"    fit_until: 0.1501 s\n", "    fit_until: 0.1001 s\n"}});
  const CalibrationProblem problem(study, BarMesh({7, 2, 2}, 2));
  const ResidualEvaluation start = problem.Predict(problem.Start(), false);
  ASSERT_TRUE(start.usable) << start.message;
  EXPECT_EQ(start.residual.size(), 6 * 150 + 11 * 3 * kMarkers);  // frames to 0.1 s of each
  const Calibration fit = FitSilently(problem);
  ASSERT_TRUE(fit.usable) << fit.message;
  EXPECT_EQ(fit.estimates.size(), 2u + 3u + 4u);  // a hold each, the markers' clock
  // A coarser mesh is 2 % stiffer, longer steps are 1 % slower.
  EXPECT_NEAR(fit.estimates[0].value, truth.young_modulus, 0.04 * truth.young_modulus);
  const std::vector<RecordingMisfit> misfits = MisfitsOf(problem, fit.parameters);
  ASSERT_EQ(misfits.size(), 2u);
  EXPECT_EQ(misfits[0].misfit.Components(), 1);
  EXPECT_EQ(misfits[1].misfit.Components(), 3);
  // Each in its own noise: nothing is missing in the model but the fineness of its mesh.
  for (const RecordingMisfit& misfit : misfits) EXPECT_LT(misfit.in_fit.rms_over_sigma, 1.5);
}

constexpr char kCarriedEnd[] =
    "gripped: [{name: tool, half_space: {point: [0.011 m, 0 m, 0 m], normal: [-1, 0, 0]}}]\n";

class CarriedBar : public testing::Test {
 protected:
  static const std::vector<TriMesh>& CarriedSurfaces() {
    static const std::vector<TriMesh> surfaces = CarriedBarSurfaces({}, CarriedPath());
    return surfaces;
  }
  // Neither held nor in gravity; only E is fitted.
  std::string Experiment(const std::map<std::string, std::string>& replaced = {}) const {
    const std::string text = BarExperiment(
        folder_.Path(), {{"  - {type: gravity, acceleration: [0, 0, -9.80665 m/s^2]}\n", ""},
                         {", {name: mass_damping.alpha}", ""},
                         {"alpha: 1 1/s", "alpha: 2 1/s"},
                         {"clock_deviation: 10 ms\n    hold:\n", ""},
                         {"      region: {half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, "
                          "0]}}\n      release: 0.0437 s\n",
                          ""},
                         {"fit_until: 0.1501 s\n    ", "fit_until: 0.1201 s\n    to: 0.2001 s\n"}});
    return WithReplacements(text, replaced);
  }
  PredictionStudy Study(const std::map<std::string, std::string>& replaced = {}) const {
    return ReadPredictionStudy(
        Config::Parse(Experiment(replaced), (folder_ / "study.yaml").string()));
  }
  std::string MessageWith(const std::string& rest) const {
    return MessageWith(rest, CarriedSurfaces());
  }
  std::string MessageWith(const std::string& rest, const std::vector<TriMesh>& surfaces,
                          const std::map<std::string, std::string>& replaced = {}) const {
    WriteBarScans(folder_.Path(), surfaces, rest);
    return MessageOf([&] {
      const PredictionStudy study = Study(replaced);
      const CalibrationProblem problem(study, BarMesh({8, 1, 1}, 2));
    });
  }

  TemporaryFolder folder_;
};

TEST_F(CarriedBar, IsFollowedByItsGrip) {
  WriteBarScans(folder_.Path(), CarriedSurfaces(), std::string(kCarriedEnd) + kShape);
  const PredictionStudy study = Study();
  const CalibrationProblem problem(study, BarMesh({8, 2, 2}, 2));
  const Grip& grip = problem.models()[0].model().grips[0];
  const Eigen::Matrix3Xd rest = problem.body()->mesh.nodes(Eigen::all, grip.nodes);
  const Eigen::Matrix3Xd path = CarriedPath();
  for (const int frame : study.recordings[0].frames) {
    const Eigen::Matrix3Xd moved =
        grip.motion(study.recordings[0].recording.times[frame]).colwise() - path.col(frame);
    // Some 700 points of 0.4 mm each, and the lever arms of a corner.
    EXPECT_LT((moved - rest).colwise().norm().maxCoeff(), 3e-4) << frame;
  }
  const Calibration fit = FitSilently(problem);
  ASSERT_TRUE(fit.usable) << fit.message;
  // The mesh, and a motion that is only known to the noise.
  EXPECT_NEAR(fit.estimates[0].value, 1e5, 0.05 * 1e5);
}

// The whole way, the reference shape being the first scan: mesh, fit, files, comparison.
TEST_F(CarriedBar, IsFittedFromItsScansAlone) {
  WriteBarScans(folder_.Path(), CarriedSurfaces(), kCarriedEnd);
  std::ofstream(folder_ / "study.yaml") << Experiment(
      {{"name: bar\n",
        "name: bar\noutput: run\nscan: {patches: 60, surface: {edge_length: 5 mm}}\n"},
       {"order: 2", "order: 1"},
       {"motion: {time_step: 1.5 ms}", "motion: {time_step: 5 ms}"}});
  const PredictionStudy study = ReadPredictionStudy(Config::Load(folder_ / "study.yaml"));
  SilentProgress progress;
  const CalibrationRecord record = RunCalibration(study, &progress);
  ASSERT_TRUE(record.usable) << record.message;
  // A shape reconstructed from noisy points, its edges rounded off, with coarse triangles: its
  // stiffness goes with the cube of its height.
  EXPECT_NEAR(record.mesh.volume, 0.08 * 0.02 * 0.02, 0.06 * 0.08 * 0.02 * 0.02);
  EXPECT_NEAR(record.parameters[0].estimate.value, 1e5, 0.3 * 1e5);
  ASSERT_TRUE(record.recordings[0].scan.has_value());
  EXPECT_EQ(record.recordings[0].scan->places.cols(), 60);
  EXPECT_GT(record.recordings[0].scan->used, 0.9);

  const CalibrationRecord read = ReadCalibration(folder_ / "run");
  EXPECT_EQ(read.scan_noise, record.scan_noise);
  EXPECT_EQ(read.recordings[0].scan->places, record.recordings[0].scan->places);
  const ComparisonRecord comparison = CompareRun(folder_ / "run").record;
  ASSERT_EQ(comparison.recordings.size(), 1u);
  const ComparedRecording& compared = comparison.recordings[0];
  EXPECT_THAT(comparison.notes, testing::IsEmpty());
  EXPECT_EQ(compared.grip_distance.size(), 60);
  ASSERT_EQ(compared.parts.size(), 2u);
  // Patches have one component; the comparison and the record of the fit have the same rms
  // and, with the noise of each patch, the same multiple of the noise.
  const ErrorSize& error = compared.parts[0].error;
  EXPECT_NEAR(error.rms, record.recordings[0].in_fit.rms, 1e-9);
  EXPECT_NEAR(error.rms_over_sigma, record.recordings[0].in_fit.rms_over_sigma, 1e-9);
  EXPECT_THAT(DescribeComparison(comparison)[0], HasSubstr("(patch "));
}

TEST_F(CarriedBar, TellsWhatItCannotFollow) {
  EXPECT_EQ(MessageWith(std::string(kCarriedEnd) + kShape), "nothing was refused");
  EXPECT_THAT(MessageWith(std::string("gripped: [{name: tool, half_space: {point: [0.002 m, 0 m, 0 "
                                      "m], normal: [-1, 0, 0]}}]\n") +
                          kShape),
              HasSubstr("tool follows the scan, but frame 0 does not determine all of its motion"));
  EXPECT_THAT(
      MessageWith(std::string("gripped: [{name: tool, sphere: {center: [0 m, 0.01 m, 0.01 m], "
                              "radius: 1 mm}}]\n") +
                  kShape),
      HasSubstr("tool follows the scan, but contains no face of the surface"));
  // What the tool hides.
  std::vector<TriMesh> without_end = CarriedSurfaces();
  std::vector<Eigen::Index> seen;
  for (Eigen::Index t = 0; t < without_end[0].triangles.cols(); ++t)
    if (without_end[0].vertices(0, without_end[0].triangles(0, t)) > 0.019) seen.push_back(t);
  const Eigen::Matrix3Xi triangles = without_end[0].triangles(Eigen::all, seen);
  for (TriMesh& surface : without_end) surface.triangles = triangles;
  EXPECT_THAT(MessageWith(std::string(kCarriedEnd) + kShape, without_end),
              HasSubstr("tool follows the scan, but frame 0 shows"));
}

TEST_F(CarriedBar, IsRefusedWhereItSaysNothing) {
  const std::string rest = std::string(kCarriedEnd) + kShape;
  EXPECT_THAT(MessageWith(rest, CarriedSurfaces(), {{"to: 0.2001 s", "to: 0.03 s"}}),
              HasSubstr("2 frames lie between 0 s and 0.03 s; at least 3 are needed"));
  EXPECT_THAT(MessageWith(rest, CarriedSurfaces(), {{"fit_until: 0.1201 s", "from: 0.1 s"}}),
              HasSubstr("the object already moves between its first two frames"));
  TetMesh elsewhere = BarMesh({8, 1, 1}, 2);
  elsewhere.nodes.row(1).array() += 0.3;
  EXPECT_THAT(MessageOf([&] {
                const PredictionStudy study = Study();
                const CalibrationProblem problem(study, elsewhere);
              }),
              HasSubstr("of 150 patches of the undeformed surface: its points lie elsewhere"));
  EXPECT_THAT(
      MessageWith(kCarriedEnd, CarriedSurfaces(),
                  {{"to: 0.2001 s",
                    "hold: {region: {sphere: {center: [0.08 m, 0 m, 0 m], radius: 5 mm}}, release: "
                    "0.1 s}"}}),
      HasSubstr("hold: the recording's reference shape is its first frame"));
}

// Where the model starts so far off that most points find no place on it, that is said.
TEST_F(CarriedBar, SaysWhereItLosesTheScan) {
  WriteBarScans(folder_.Path(), HeldSurfaces(), std::string(kClampedEnd) + kShape);
  const PredictionStudy study =
      ReadBarStudy(folder_.Path(), {{"fit_until: 0.1501", "fit_until: 0.2001"},
                                    {"young_modulus: 0.15 MPa", "young_modulus: 3 kPa"},
                                    {"place_deviation", "scan: {reach: 0.03}\nplace_deviation"}});
  const CalibrationProblem problem(study, BarMesh({8, 1, 1}, 2));
  const Misfit start = MisfitsOf(problem, problem.Start())[0].misfit;
  EXPECT_THAT(problem.models()[0].LostFrames(start, 0.85), testing::SizeIs(testing::Gt(8u)));
  const Calibration fit = FitSilently(problem);
  EXPECT_FALSE(fit.usable);
  EXPECT_THAT(fit.message, HasSubstr("frames most scanned points are farther than scan.reach"));
}

}  // namespace
}  // namespace lacuna
