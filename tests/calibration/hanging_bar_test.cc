// What is not known of a body that hangs under its own weight: its density and where its clamp is.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <random>

#include "calibration/calibration_problem.h"
#include "calibration/calibration_run.h"
#include "effects/catalogue.h"
#include "effects/gravity.h"
#include "effects/uniform_density.h"
#include "fem/prediction.h"
#include "geometry/embedding.h"
#include "prediction/prediction_study_reader.h"
#include "support/held_bar.h"
#include "support/replace_in_file.h"
#include "support/silent_fit.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::ElementsAre;

constexpr double kModulus = 3e5;  // Pa: a bar of 80 mm sags by 5 mm
constexpr int kStills = 10;

// The markers of a bar of 1000 kg/m³ that is clamped at x = 0 and hangs still.
std::vector<Eigen::Matrix3Xd> FilmHangingBar() {
  Model model;
  model.body = std::make_shared<const Body>(MakeBody(BarMesh({8, 2, 2}, 2), 1000));
  const TetMesh& mesh = model.body->mesh;
  model.effects = {MakeEffect("neo_hookean", {{"young_modulus", kModulus}, {"poisson_ratio", 0.4}}),
                   MakeGravity({0, 0, -9.80665})};
  model.grips = {{NodesWhere(mesh, [](const Eigen::Vector3d& at) { return at.x() < 0.002; }), {}}};
  PredictionOptions options;
  options.step.scheme = TimeScheme::kQuasiStatic;
  Eigen::Matrix3Xd still;
  const PredictionSummary summary =
      Predict(model, options, {0.01}, {}, [&](int, const PredictedState& state) {
        still = PointsAt(Embed(mesh, BarMarkerPlaces()), mesh,
                         state.position.reshaped(3, mesh.NodeCount()));
      });
  EXPECT_TRUE(summary.IsUsable()) << summary.message;
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 5e-5);
  std::vector<Eigen::Matrix3Xd> frames(kStills, still);
  for (Eigen::Matrix3Xd& frame : frames)
    for (double& coordinate : frame.reshaped()) coordinate += noise(random);
  return frames;
}

// `more`: further keys of the experiment, one a line.
std::string HangingExperiment(const std::filesystem::path& folder, const std::string& more) {
  return BarExperiment(
      folder, {{"noise: 0.05 mm\n", "noise: 0.05 mm\noutput: run\n" + more},
               {"place_deviation: 0.2 mm", "place_deviation: 0.05 mm"},
               {"  - {type: mass_damping, alpha: 1 1/s}\n", ""},
               {"{name: young_modulus}, {name: mass_damping.alpha}", "{name: young_modulus}"},
               {"motion: {time_step: 1.5 ms}", "motion: {scheme: quasi_static}"},
               {"    clock_deviation: 10 ms\n    hold:\n      region: {half_space: {point: [0.078 "
                "m, 0 m, 0 m], normal: [1, 0, 0]}}\n      release: 0.0437 s\n",
                ""}});
}

PredictionStudy HangingStudy(const std::filesystem::path& folder, const std::string& more) {
  return ReadPredictionStudy(
      Config::Parse(HangingExperiment(folder, more), (folder / "study.yaml").string()));
}

// Gives the clamp of the recording in `folder` an uncertain placement.
void LoosenClamp(const std::filesystem::path& folder) {
  const std::string normal = "normal: [-1, 0, 0]}";
  ReplaceInFile(folder / "recording.yaml", normal,
                normal + ", placement: {shift_deviation: 1 mm, turn_deviation: 2 deg}");
}

std::vector<std::string> NamesOf(const CalibrationProblem& problem) {
  std::vector<std::string> names;
  for (const CalibratedParameter& parameter : problem.parameters()) names.push_back(parameter.name);
  return names;
}

// The equilibrium under its own weight depends on E/ρ alone. With the standard deviations s of ln ρ
// (prior) and d of ln(E/ρ) (data) that of ln E is √(d² + s²), and that of ln ρ stays s.
TEST(HangingBar, LeavesTheModulusAsUncertainAsTheDensity) {
  constexpr double kDensityDeviation = 0.05;
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHangingBar());
  const PredictionStudy exact = HangingStudy(folder.Path(), "");
  const PredictionStudy uncertain = HangingStudy(folder.Path(), "density_deviation: 0.05\n");
  const TetMesh mesh = BarMesh({6, 2, 2}, 2);
  const CalibrationProblem exact_problem(exact, mesh), problem(uncertain, mesh);
  EXPECT_THAT(NamesOf(exact_problem), ElementsAre("young_modulus"));
  ASSERT_THAT(NamesOf(problem), ElementsAre("young_modulus", "density"));
  EXPECT_EQ(problem.UnitOf(1), "kg/m^3");

  const ResidualEvaluation at = problem.Predict(problem.Start(), true);
  ASSERT_TRUE(at.usable) << at.message;
  const Eigen::VectorXd by_modulus = problem.Start()[0] * at.jacobian.col(0);
  const Eigen::VectorXd by_density = problem.Start()[1] * at.jacobian.col(1);
  // Sensitivities are solved to 1e-4.
  EXPECT_LT((by_modulus + by_density).norm(), 1e-3 * by_modulus.norm());

  const Calibration known = FitSilently(exact_problem), fit = FitSilently(problem);
  ASSERT_TRUE(known.usable && fit.usable) << known.message << fit.message;
  const double data = known.estimates[0].posterior_deviation;
  EXPECT_LT(data, 0.5 * kDensityDeviation) << "or the density would hardly matter";
  // The prior of E spans a factor of more than ten and reduces the deviation by 0.1 % at most; two
  // fits stop within 1e-3 deviations of each other.
  EXPECT_NEAR(fit.estimates[0].posterior_deviation, std::hypot(data, kDensityDeviation),
              0.01 * kDensityDeviation);
  EXPECT_NEAR(fit.estimates[1].posterior_deviation, kDensityDeviation, 0.01 * kDensityDeviation);
  EXPECT_NEAR(std::log(fit.estimates[0].high / fit.estimates[0].low),
              2 * kNormalQuantile * fit.estimates[0].posterior_deviation, 1e-9);
  // Nothing pulls the density away from its prior.
  EXPECT_NEAR(fit.parameters[1], 1000, 0.05 * kDensityDeviation * 1000);
  EXPECT_NEAR(fit.parameters[0], known.parameters[0], 0.01 * known.parameters[0]);
}

TEST(HangingBar, IsReadBackWithTheDensityThatWasFitted) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHangingBar());
  const auto run = [&](const std::string& text) {
    std::ofstream(folder / "study.yaml") << text;
    SilentProgress progress;
    return RunCalibration(ReadPredictionStudy(Config::Load(folder / "study.yaml")), &progress);
  };
  const CalibrationRecord exact = run(HangingExperiment(folder.Path(), ""));
  ASSERT_TRUE(exact.usable) << exact.message;
  const double modulus = exact.parameters.at(0).estimate.value;  // with 1000 kg/m³
  // The moduli of a denser bar are larger; a modulus known beforehand decides the density instead.
  const CalibrationRecord record =
      run(WithReplacements(HangingExperiment(folder.Path(), "density_deviation: 0.2\n"),
                           {{"{name: young_modulus}",
                             fmt::format("{{name: young_modulus, mean: {} Pa, deviation: {} Pa}}",
                                         1.1 * modulus, 0.003 * modulus)}}));
  ASSERT_TRUE(record.usable) << record.message;
  ASSERT_EQ(record.parameters.at(1).name, "density");
  // E/ρ is that of the exact density. The prior of the density moves it by (1/20)² of 10 %.
  EXPECT_NEAR(record.parameters[1].estimate.value, 1100, 5);
  for (const HeldParameter& held : record.held)
    EXPECT_FALSE(held.name.find("density") != std::string::npos) << held.name;

  const FittedRun opened = OpenRun(folder / "run");
  // The body stays that of the given density, to which its effect adds the rest.
  EXPECT_EQ(opened.study.density, 1000);
  EXPECT_EQ(DensityWith(opened.study.effects, opened.study.density),
            record.parameters[1].estimate.value);
}

// The fitted density is an effect beside a body of the given density, to which mass-proportional
// damping refers. A run that is read back therefore predicts what was fitted.
TEST(HangingBar, MovesAsItWasFittedWhenItIsReadBack) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  // The truth with modulus, density and hold 10 % larger; 2 1/s at 1100 kg/m³ are 2.2 1/s at 1000.
  std::ofstream(folder / "study.yaml") << BarExperiment(
      folder.Path(), {{"noise: 0.05 mm\n", "noise: 0.05 mm\noutput: run\ndensity_deviation: 0.2\n"},
                      {"alpha: 1 1/s", "alpha: 2.2 1/s"},
                      {"{name: young_modulus}, {name: mass_damping.alpha}",
                       "{name: young_modulus, mean: 110 kPa, deviation: 1 kPa}"}});
  const PredictionStudy study = ReadPredictionStudy(Config::Load(folder / "study.yaml"));
  SilentProgress progress;
  const CalibrationRecord record = RunCalibration(study, &progress);
  ASSERT_TRUE(record.usable) << record.message;
  ASSERT_EQ(record.parameters.at(1).name, "density");
  EXPECT_GT(record.parameters[1].estimate.value, 1040) << "or the density would hardly matter";

  const FittedRun opened = OpenRun(folder / "run");
  const CalibrationProblem before(study, opened.mesh), after(opened.study, opened.mesh);
  const ResidualEvaluation first = before.Predict(opened.values, false);
  const ResidualEvaluation second = after.Predict(opened.values, false);
  ASSERT_TRUE(first.usable && second.usable) << first.message << second.message;
  ASSERT_EQ(first.residual.size(), second.residual.size());
  // The same computation. Damping of the fitted density would differ by σ and more in many rows.
  EXPECT_LT((first.residual - second.residual).norm(), 1e-6);
}

TEST(HangingBar, FollowsItsClamp) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHangingBar());
  LoosenClamp(folder.Path());
  const PredictionStudy study = HangingStudy(folder.Path(), "");
  const CalibrationProblem problem(study, BarMesh({6, 2, 2}, 2));
  ASSERT_THAT(
      NamesOf(problem),
      ElementsAre("young_modulus", "bar.clamp.shift_x", "bar.clamp.shift_y", "bar.clamp.shift_z",
                  "bar.clamp.turn_x", "bar.clamp.turn_y", "bar.clamp.turn_z"));
  EXPECT_EQ(problem.UnitOf(1), "m");
  EXPECT_EQ(problem.UnitOf(4), "rad");
  const LinearisedMisfit here = problem.Linearise(problem.Start(), {.with_jacobian = true});
  ASSERT_TRUE(here.usable) << here.message;
  // Gravity is uniform: the whole bar is displaced with its clamp.
  for (Eigen::Index row = 0; row < here.residual.size(); ++row)
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(here.jacobian(row, 1 + axis), row % 3 == axis ? 1 : 0, 1e-3);  // solved to 1e-4
  Eigen::VectorXd displaced = problem.Start();
  displaced.segment<3>(1) << 2e-3, -1e-3, 3e-3;
  const LinearisedMisfit there = problem.Linearise(displaced);
  ASSERT_TRUE(there.usable) << there.message;
  const Eigen::VectorXd moved = displaced.segment<3>(1).replicate(here.residual.size() / 3, 1);
  // Equilibria are known to 1e-6 of the forces, a few nm.
  EXPECT_LT((there.residual - here.residual - moved).lpNorm<Eigen::Infinity>(), 1e-6);
}

// In motion, with a clamp that is placed elsewhere and a density that is not the body's.
TEST(HangingBar, HasTheDerivativesByDensityAndPlacementInMotion) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  LoosenClamp(folder.Path());
  const PredictionStudy study =
      ReadBarStudy(folder.Path(), {{"noise: 0.05 mm", "density_deviation: 0.05\nnoise: 0.05 mm"},
                                   {", {name: mass_damping.alpha}", ""},
                                   {"    clock_deviation: 10 ms\n", ""}});
  const CalibrationProblem problem(study, BarMesh({6, 2, 2}, 2));
  ASSERT_THAT(
      NamesOf(problem),
      ElementsAre("young_modulus", "density", "bar.hold_force_x", "bar.hold_force_y",
                  "bar.hold_force_z", "bar.clamp.shift_x", "bar.clamp.shift_y", "bar.clamp.shift_z",
                  "bar.clamp.turn_x", "bar.clamp.turn_y", "bar.clamp.turn_z"));
  Eigen::VectorXd at = problem.Start(), steps(11);
  // A turn at which its derivative differs by 2 % from that at zero.
  at.tail(10) << 1070, 0.01, 0.03, -0.02, 1e-3, -2e-3, 1e-3, 0.02, -0.03, 0.015;
  steps << 200, 1, 2e-3, 2e-3, 2e-3, 1e-4, 1e-4, 1e-4, 1e-3, 1e-3, 1e-3;
  const LinearisedMisfit here = problem.Linearise(at, {.with_jacobian = true});
  ASSERT_TRUE(here.usable) << here.message;
  for (Eigen::Index k = 0; k < at.size(); ++k) {
    const Eigen::VectorXd shift = steps[k] * Eigen::VectorXd::Unit(at.size(), k);
    const Eigen::VectorXd difference =
        (problem.Linearise(at + shift, {.correspondences = &here}).residual -
         problem.Linearise(at - shift, {.correspondences = &here}).residual) /
        (2 * steps[k]);
    EXPECT_GT(difference.norm(), 0) << NamesOf(problem)[static_cast<size_t>(k)];
    // Truncation, and trajectories that are known to 1e-8 of the forces only.
    EXPECT_LT((here.jacobian.col(k) - difference).norm(), 2e-3 * difference.norm())
        << NamesOf(problem)[static_cast<size_t>(k)];
  }
}

}  // namespace
}  // namespace lacuna
