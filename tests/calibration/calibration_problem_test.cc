#include "calibration/calibration_problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "calibration/calibration_fits.h"
#include "calibration/held_out_misfit.h"
#include "calibration/linear_misfit.h"
#include "core/parallel.h"
#include "effects/catalogue.h"
#include "prediction/recording_noise.h"
#include "record/csv_table.h"
#include "support/held_bar.h"
#include "support/replace_in_file.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// Coarser than what was filmed.
TetMesh StudyMesh() { return BarMesh({7, 2, 2}, 2); }

Calibration FitOf(const CalibrationProblem& problem) {
  SilentProgress progress;
  return FitFromStart(problem, &progress);
}

TEST(CalibrationProblem, JacobianAgreesWithDifferences) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study =
      ReadBarStudy(folder.Path(), {{"{name: mass_damping.alpha}",
                                    "{name: poisson_ratio}, {name: mass_damping.alpha}, "
                                    "{name: gravity.acceleration_z}"},
                                   {"clock_deviation: 10 ms\n",
                                    "clock_deviation: 10 ms\n    registration: {shift_deviation: "
                                    "1 mm, turn_deviation: 1 deg}\n"}});
  const CalibrationProblem problem(study, StudyMesh());
  constexpr Eigen::Index kCount = 14;
  std::vector<std::string> names;
  for (const CalibratedParameter& parameter : problem.parameters()) names.push_back(parameter.name);
  EXPECT_THAT(names,
              testing::ElementsAre("young_modulus", "poisson_ratio", "mass_damping.alpha",
                                   "gravity.acceleration_z", "bar.hold_force_x", "bar.hold_force_y",
                                   "bar.hold_force_z", "bar.clock", "bar.shift_x", "bar.shift_y",
                                   "bar.shift_z", "bar.turn_x", "bar.turn_y", "bar.turn_z"));
  EXPECT_EQ(problem.UnitOf(7), "s");
  EXPECT_EQ(problem.UnitOf(13), "rad");
  Eigen::VectorXd at = problem.Start();
  // A turn's derivative is that of a small one.
  at.tail(10) << 0.01, 0.03, -0.02, 0.001, 1e-3, -2e-3, 1e-3, 5e-4, -3e-4, 2e-4;
  const Eigen::VectorXd steps = (Eigen::VectorXd(kCount) << 200, 1e-3, 1e-2, 1e-2, 2e-3, 2e-3, 2e-3,
                                 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4)
                                    .finished();
  // How errors of the markers' places show is what it is at `at`.
  const LinearisedMisfit here = problem.Linearise(at, {.with_jacobian = true});
  ASSERT_TRUE(here.usable) << here.message;
  ASSERT_EQ(here.jacobian.cols(), kCount);
  for (Eigen::Index k = 0; k < kCount; ++k) {
    const Eigen::VectorXd shift = steps[k] * Eigen::VectorXd::Unit(kCount, k);
    const Eigen::VectorXd difference =
        (problem.Linearise(at + shift, {.correspondences = &here}).residual -
         problem.Linearise(at - shift, {.correspondences = &here}).residual) /
        (2 * steps[k]);
    // Truncation, and trajectories that are known to 1e-8 of the forces only.
    EXPECT_LT((here.jacobian.col(k) - difference).norm(), 1e-3 * difference.norm()) << names[k];
  }
  // And the fitted frames of that, whitened, are what is fitted.
  const ResidualEvaluation fitted = problem.Predict(at, true);
  ASSERT_TRUE(fitted.usable) << fitted.message;
  const Eigen::MatrixXd white = WhitenedRows(here.jacobian, here, {.fitted_only = true});
  EXPECT_LT((fitted.jacobian - white.topRows(fitted.jacobian.rows())).norm(),
            1e-6 * fitted.jacobian.norm());
}

// Poisson's ratio of the material, which the branch and the lump share.
TEST(CalibrationProblem, DifferentiatesBySettingsThatFollowTheMaterial) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study = ReadBarStudy(
      folder.Path(),
      {{"  - {type: mass_damping, alpha: 1 1/s}\n",
        "  - {type: viscoelastic_branch, modulus: 100 kPa, relaxation_time: 20 ms}\n"
        "  - {type: inclusion, young_modulus_difference: 100 kPa, centre: [0.02 m, 0, 0], radius: "
        "10 mm}\n"},
       {"{name: young_modulus}, {name: mass_damping.alpha}", "{name: poisson_ratio}"},
       {"    clock_deviation: 10 ms\n", ""}});
  ASSERT_EQ(study.fitted.at(0).places.size(), 3u);
  const CalibrationProblem problem(study, BarMesh({3, 1, 1}, 2));
  Eigen::VectorXd at = problem.Start();
  at.tail<3>() << 0.01, 0.03, -0.02;  // the force of the hold
  constexpr double kStep = 1e-3;
  const Eigen::VectorXd shift = kStep * Eigen::VectorXd::Unit(at.size(), 0);
  const LinearisedMisfit here = problem.Linearise(at, {.with_jacobian = true});
  ASSERT_TRUE(here.usable) << here.message;
  const Eigen::VectorXd difference =
      (problem.Linearise(at + shift, {.correspondences = &here}).residual -
       problem.Linearise(at - shift, {.correspondences = &here}).residual) /
      (2 * kStep);
  // Truncation, and sensitivities that are solved to 1e-4.
  EXPECT_LT((here.jacobian.col(0) - difference).norm(), 2e-3 * difference.norm());
}

// Half of the markers are hidden in every second frame.
TEST(CalibrationProblem, CountsOnlyMarkersThatAreSeen) {
  const TemporaryFolder folder;
  std::vector<Eigen::Matrix3Xd> markers = FilmHeldBar({});
  for (size_t frame = 1; frame < markers.size(); frame += 2)
    for (Eigen::Index m = 1; m < kMarkers; m += 2)
      markers[frame].col(m).setConstant(std::numeric_limits<double>::quiet_NaN());
  WriteBarRecording(folder.Path(), markers);
  const PredictionStudy study = ReadBarStudy(folder.Path());
  const CalibrationProblem problem(study, BarMesh({3, 1, 1}, 1));
  const ResidualEvaluation prediction = problem.Predict(problem.Start(), false);
  ASSERT_TRUE(prediction.usable) << prediction.message;
  constexpr Eigen::Index kFitted = 16;  // frames, 0 to 0.15 s
  ASSERT_EQ(prediction.residual.size(), 3 * kMarkers * kFitted);
  EXPECT_EQ(prediction.unobserved, 3 * (kMarkers / 2) * (kFitted / 2));
  const double seen = 0.75 * static_cast<double>(prediction.residual.size());
  EXPECT_NEAR(RootMeanSquare(prediction), prediction.residual.norm() / std::sqrt(seen), 1e-12);
}

// What a prediction that breaks off would have been compared with binds no later one.
TEST(CalibrationProblem, APredictionThatBreaksOffLeavesNothingBehind) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study = ReadBarStudy(folder.Path());
  const CalibrationProblem problem(study, StudyMesh());
  constexpr double kWhole = std::numeric_limits<double>::infinity();
  CalibrationProblem::FitMemory memory;
  Eigen::VectorXd liquid = problem.Start();
  liquid[0] = 1;  // Pa
  EXPECT_FALSE(problem.Predict(liquid, false, kWhole, &memory).usable);
  EXPECT_TRUE(memory.correspondences.empty());
  const ResidualEvaluation after = problem.Predict(problem.Start(), false, kWhole, &memory);
  ASSERT_TRUE(after.usable) << after.message;
  EXPECT_EQ(after.residual, problem.Predict(problem.Start(), false).residual);
}

TEST(CalibrationProblem, RecoversWhatWasFilmed) {
  const TemporaryFolder folder;
  const HeldBarTruth truth;
  WriteBarRecording(folder.Path(), FilmHeldBar(truth));
  const PredictionStudy study = ReadBarStudy(folder.Path());
  const CalibrationProblem problem(study, StudyMesh());
  const Calibration fit = FitOf(problem);
  ASSERT_TRUE(fit.usable) << fit.message;
  const ParameterEstimate& modulus = fit.estimates[0];
  // A coarser mesh of the same elements is 2 % stiffer, longer steps are 1 % slower.
  EXPECT_NEAR(modulus.value, truth.young_modulus, 0.04 * truth.young_modulus);
  EXPECT_EQ(modulus.determination, Determination::kPinnedDown);
  EXPECT_LT(modulus.low, modulus.value);
  EXPECT_GT(modulus.high, modulus.value);
  const double width = modulus.high - modulus.low;
  EXPECT_GT(width, 0.005 * modulus.value);
  EXPECT_LT(width, 0.1 * modulus.value);
  EXPECT_LT(std::abs(modulus.value - truth.young_modulus), width);  // mesh and steps included
  const ParameterEstimate& alpha = fit.estimates[1];
  EXPECT_LT(alpha.low, truth.alpha);
  EXPECT_GT(alpha.high, truth.alpha);
  const Eigen::VectorXd nuisance = problem.NuisanceOf(0, fit.parameters);
  // Within the intervals, some 2 mN and, along the bar, where it moves nothing, 12 mN; 0.5 ms.
  EXPECT_NEAR(nuisance[0], truth.hold_force.x(), 0.015);
  EXPECT_NEAR(nuisance[1], truth.hold_force.y(), 0.003);
  EXPECT_NEAR(nuisance[2], truth.hold_force.z(), 0.003);
  EXPECT_NEAR(nuisance[3], truth.clock, 5e-4);

  EXPECT_LT(fit.rms, 1.3);
  EXPECT_GT(fit.start_rms, 2 * fit.rms);
  const std::vector<RecordingMisfit> misfits = MisfitsOf(problem, fit.parameters);
  ASSERT_EQ(misfits.size(), 1u);
  EXPECT_EQ(misfits[0].in_fit.frames, 16);  // 0 to 0.15 s
  EXPECT_EQ(misfits[0].held_out.frames, kFrames - 16);
  EXPECT_EQ(misfits[0].held_out.points, (kFrames - 16) * kMarkers);
  EXPECT_LT(misfits[0].in_fit.rms_over_sigma, 1.3);
  // The discretisation shows in the frames that were not fitted: 0.14 mm after 20 mm of motion.
  EXPECT_LT(misfits[0].held_out.rms_over_sigma, 2.5);
  EXPECT_GE(misfits[0].held_out.largest, misfits[0].held_out.rms);
}

// A quarter of the fitted time would be rest, from which nothing could be fitted.
TEST(CalibrationFits, TheFirstPartBeginsWhereTheObjectMoves) {
  const TemporaryFolder folder;
  const std::vector<Eigen::Matrix3Xd> moving = FilmHeldBar({});
  const auto horizon = [&](const std::string& name, int resting) {
    std::vector<Eigen::Matrix3Xd> late = moving;
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, 5e-5);
    for (int frame = 0; frame < resting; ++frame) {
      late[frame] = moving.front();
      for (double& coordinate : late[frame].reshaped()) coordinate += noise(random);
    }
    WriteBarRecording(folder / name, late);
    return ShortHorizon(CalibrationProblem(ReadBarStudy(folder / name), StudyMesh()));
  };
  const double last = 0.15;
  EXPECT_NEAR(horizon("late", 11), 0.1 - kRelease + 0.25 * (last - 0.1), 1e-9);
  // In the 6 ms from its release to the next frame it hardly moves.
  EXPECT_NEAR(horizon("at_once", 0), 0.05 - kRelease + 0.25 * (last - 0.05), 1e-9);
}

// Neither the frames after `fit_until` nor a recording that is only predicted, not even through the
// estimate of the noise.
TEST(CalibrationProblem, DoesNotUseWhatIsHeldOut) {
  const TemporaryFolder folder;
  const std::vector<Eigen::Matrix3Xd> filmed = FilmHeldBar({});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shift(-0.005, 0.005);
  const auto shifted_from = [&](size_t first) {
    std::vector<Eigen::Matrix3Xd> altered = filmed;
    for (size_t frame = first; frame < altered.size(); ++frame)
      for (double& coordinate : altered[frame].reshaped()) coordinate += shift(random);
    return altered;
  };
  const auto fit = [&](const std::string& name, const std::vector<Eigen::Matrix3Xd>& first,
                       const std::vector<Eigen::Matrix3Xd>& second) {
    WriteBarRecording(folder / name, first);
    WriteBarRecording(folder / name / "other", second);
    const PredictionStudy study = ReadBarStudy(
        folder / name, {{"noise: 0.05 mm\n", ""},
                        {"recordings:\n",
                         "recordings:\n  - recording: other/recording.yaml\n    name: other\n"
                         "    fitted: false\n    hold:\n      region: {half_space: {point: "
                         "[0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}\n      release: 0.0437 s\n"}});
    const CalibrationProblem problem(study, BarMesh({3, 1, 1}, 2));
    const Calibration calibration = FitOf(problem);
    EXPECT_TRUE(calibration.usable) << calibration.message;
    return calibration;
  };
  const Calibration plain = fit("plain", filmed, filmed);
  const Calibration altered = fit("altered", shifted_from(16), shifted_from(8));
  EXPECT_EQ(altered.parameters, plain.parameters);
  EXPECT_EQ(altered.covariance, plain.covariance);
  const Calibration other = fit("other", shifted_from(15), filmed);
  EXPECT_NE(other.parameters, plain.parameters);
}

// As if marker m7 were 1.5 mm nearer to the clamp than it is.
void Misplace(const std::filesystem::path& file) {
  ReplaceInFile(file, "m7, position: [0.08 m", "m7, position: [0.0785 m");
}

// Where a marker is on the object, a fitted recording tells for one that is not fitted.
// Lists the markers of a recording in the opposite order, under their names.
void ReverseMarkers(const std::filesystem::path& folder) {
  const CsvTable table = LoadCsv(folder / "markers.csv");
  CsvTable reversed{table[0]};
  for (size_t m = table.size() / 3; m > 0; --m)
    reversed.insert(reversed.end(), {table[3 * m - 2], table[3 * m - 1], table[3 * m]});
  SaveCsv(reversed, folder / "markers.csv");
}

TEST(CalibrationProblem, KnowsMisplacedMarkersFromFittedRecordings) {
  const TemporaryFolder folder;
  HeldBarTruth other_hold;
  other_hold.hold_force = {0, -0.03, 0.04};
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  WriteBarRecording(folder / "other", FilmHeldBar(other_hold));
  ReverseMarkers(folder / "other");
  const auto misfits = [&] {
    const PredictionStudy study = ReadBarStudy(
        folder.Path(), {{"recordings:\n",
                         "recordings:\n  - recording: other/recording.yaml\n    name: other\n"
                         "    fitted: false\n    clock_deviation: 10 ms\n"
                         "    hold:\n      region: {half_space: {point: "
                         "[0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}\n      release: 0.0437 s\n"},
                        {"place_deviation: 0.2 mm", "place_deviation: 1 mm"}});
    const CalibrationProblem problem(study, BarMesh({6, 2, 2}, 2));
    const Calibration calibration = FitOf(problem);
    EXPECT_TRUE(calibration.usable) << calibration.message;
    return MisfitsOf(problem, calibration.parameters);
  };
  Misplace(folder / "other" / "recording.yaml");
  const std::vector<RecordingMisfit> apart = misfits();
  EXPECT_TRUE(apart[0].has_own_places);
  Misplace(folder / "recording.yaml");
  const std::vector<RecordingMisfit> together = misfits();
  EXPECT_FALSE(together[0].has_own_places);
  // Each from a prediction whose equilibrium was sought near another one.
  EXPECT_LT((together[0].place_offset.rowwise().reverse() - together[1].place_offset)
                .lpNorm<Eigen::Infinity>(),
            1e-9);
  EXPECT_NEAR(std::abs(together[1].place_offset(0, 7)), 1.5e-3, 2e-4);
  // The meshes differ.
  EXPECT_LT(together[0].held_out.rms, 3e-4);
  // At the measured places, one of the markers is 1.5 mm off in every frame.
  const MisfitMeasure& measure = together[0].held_out;
  const double markers = measure.points / static_cast<double>(measure.frames);
  EXPECT_NEAR(std::pow(measure.rms_at_measured_places, 2) - std::pow(measure.rms, 2),
              std::pow(1.5e-3, 2) / markers, 0.3 * std::pow(1.5e-3, 2) / markers);
}

// On two cores, with an effect that both recordings share and that remembers.
TEST(CalibrationProblem, PredictsRecordingsSideBySideAsOneAfterTheOther) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  HeldBarTruth other_hold;
  other_hold.hold_force = {0, -0.03, 0.04};
  WriteBarRecording(folder / "other", FilmHeldBar(other_hold));
  const PredictionStudy study = ReadBarStudy(
      folder.Path(),
      {{"  - {type: mass_damping, alpha: 1 1/s}\n",
        "  - {type: mass_damping, alpha: 1 1/s}\n"
        "  - {type: viscoelastic_branch, modulus: 20 kPa, relaxation_time: 20 ms}\n"},
       {"{name: mass_damping.alpha}",
        "{name: viscoelastic_branch.modulus}, {name: viscoelastic_branch.relaxation_time}"},
       {"recordings:\n",
        "recordings:\n  - recording: other/recording.yaml\n    name: other\n    hold:\n"
        "      region: {half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}\n"
        "      release: 0.0437 s\n"}});
  const int threads = ThreadCount();
  ResidualEvaluation prediction[2];
  LinearisedMisfit linearised[2];
  std::vector<RecordingMisfit> misfits[2];
  for (int k = 0; k < 2; ++k) {
    SetThreadCount(k + 1);
    // A study of its own: an equilibrium is sought from the last one that was found.
    const CalibrationProblem own(study, BarMesh({6, 2, 2}, 1));
    prediction[k] = own.Predict(own.Start(), true);
    linearised[k] = own.Linearise(own.Start(), {.with_jacobian = true});
    misfits[k] = MisfitsOf(own, own.Start());
    ASSERT_TRUE(prediction[k].usable) << prediction[k].message;
    ASSERT_TRUE(linearised[k].usable) << linearised[k].message;
  }
  SetThreadCount(threads);
  EXPECT_EQ(prediction[0].residual, prediction[1].residual);
  EXPECT_EQ(prediction[0].jacobian, prediction[1].jacobian);
  EXPECT_EQ(linearised[0].residual, linearised[1].residual);
  EXPECT_EQ(linearised[0].jacobian, linearised[1].jacobian);
  for (size_t r = 0; r < 2; ++r) EXPECT_EQ(misfits[0][r].in_fit.rms, misfits[1][r].in_fit.rms);
}

// Of a recording that is not fitted, the coordinate system may have been set up anew.
TEST(CalibrationProblem, KnowsTheRegistrationOfARecording) {
  const TemporaryFolder folder;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, -2, 2) / 3).toRotationMatrix();
  std::vector<Eigen::Matrix3Xd> markers = FilmHeldBar({});
  WriteBarRecording(folder.Path(), markers);
  for (Eigen::Matrix3Xd& frame : markers)
    frame = (turn * frame).colwise() + Eigen::Vector3d(0.5e-3, 1e-3, -0.7e-3);
  WriteBarRecording(folder / "other", markers);
  const auto misfits = [&](const std::string& registration) {
    const PredictionStudy study =
        ReadBarStudy(folder.Path(),
                     {{"recordings:\n",
                       "recordings:\n  - recording: other/recording.yaml\n    name: other\n"
                       "    fitted: false\n    clock_deviation: 10 ms\n" +
                           registration +
                           "    hold:\n      region: {half_space: {point: "
                           "[0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}\n      release: 0.0437 s\n"}});
    const CalibrationProblem problem(study, BarMesh({6, 2, 2}, 2));
    const Calibration calibration = FitOf(problem);
    EXPECT_TRUE(calibration.usable) << calibration.message;
    return MisfitsOf(problem, calibration.parameters);
  };
  EXPECT_GT(misfits("")[0].held_out.rms, 1e-3);
  const std::vector<RecordingMisfit> registered =
      misfits("    registration: {shift_deviation: 1 mm, turn_deviation: 1 deg}\n");
  // As well as the same motion is predicted in the coordinate system of the model.
  EXPECT_LT(registered[0].held_out.rms,
            1.2 * std::max(registered[1].in_fit.rms, registered[1].held_out.rms));
}

std::string MessageOf(const PredictionStudy& study) {
  try {
    const CalibrationProblem problem(study, BarMesh({2, 1, 1}, 1));
  } catch (const InputError& problem) {
    return problem.what();
  }
  return "nothing was refused";
}

TEST(CalibrationProblem, TellsWhatItCannotWorkWith) {
  const TemporaryFolder folder;
  // At rest, 2 mm from where the undeformed bar has the markers.
  const Eigen::Matrix3Xd moved = BarMarkerPlaces().array() + 0.002;
  WriteBarRecording(folder.Path(), std::vector<Eigen::Matrix3Xd>(kFrames, moved));
  EXPECT_THAT(MessageOf(ReadBarStudy(folder.Path(), {{"noise: 0.05 mm\n", ""}})),
              testing::HasSubstr("noise: cannot be estimated (the markers do not move at all"));
  const std::string hold =
      "    hold:\n      region: {half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}\n"
      "      release: 0.0437 s\n";
  EXPECT_THAT(
      MessageOf(ReadBarStudy(folder.Path(),
                             {{"noise: 0.05 mm\n", ""},
                              {"motion: {time_step: 1.5 ms}", "motion: {scheme: quasi_static}"},
                              {hold, "    to: 0.005 s\n"}})),
      testing::HasSubstr("noise: cannot be estimated (fewer than three frames of markers are "));
  PredictionStudy not_fitted = ReadBarStudy(folder.Path(), {{"noise: 0.05 mm\n", ""}});
  not_fitted.recordings[0].fitted = false;  // as beside scans that are fitted
  EXPECT_THAT(MessageOf(not_fitted),
              testing::HasSubstr("noise: cannot be estimated (no recording of markers is fitted)"));
  EXPECT_THAT(
      MessageOf(ReadBarStudy(folder.Path(), {{"[0.078 m, 0 m, 0 m]", "[0.1 m, 0 m, 0 m]"}})),
      testing::HasSubstr("hold of bar"));
  EXPECT_EQ(MessageOf(ReadBarStudy(folder.Path())), "nothing was refused");
  const auto message_with_clamp = [&](const std::string& regions) {
    std::string text = FileContent(folder / "recording.yaml");
    const size_t first = text.find("fixed: [") + 8;
    text.replace(first, text.find("]\n", first) - first, regions);
    std::ofstream(folder / "recording.yaml") << text;
    return MessageOf(ReadBarStudy(folder.Path()));
  };
  const std::string clamp =
      "{name: clamp, half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}}";
  EXPECT_EQ(message_with_clamp(clamp), "nothing was refused");
  EXPECT_THAT(
      message_with_clamp(clamp +
                         ", {name: end, box: {min: [-1 m, -1 m, -1 m], max: [0.001 m, 1 m, 1 m]}}"),
      testing::HasSubstr("regions \"clamp\" and \"end\" hold the same part"));
  EXPECT_THAT(message_with_clamp("{name: all, half_space: {point: [1 m, 0 m, 0 m], "
                                 "normal: [-1, 0, 0]}}"),
              testing::HasSubstr("region \"all\" holds the whole object"));
  WriteBarRecording(folder.Path(), std::vector<Eigen::Matrix3Xd>(kFrames, moved));
  std::string text = FileContent(folder / "recording.yaml");
  const size_t place = text.find("[", text.find("name: m2")) + 1;
  text.replace(place, text.find(" m", place) - place, "0.5");
  std::ofstream(folder / "recording.yaml") << text;
  EXPECT_THAT(MessageOf(ReadBarStudy(folder.Path())),
              testing::HasSubstr("marker_places: m2 sits 420 mm away from the object"));
}

// A steady motion adds nothing, a marker that is not seen is passed over.
TEST(MarkerNoise, IsThatOfTheCoordinates) {
  constexpr double kNoise = 2e-4;
  PredictedRecording item;
  item.recording.markers.places = Eigen::Matrix3Xd::Random(3, 20);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, kNoise);
  std::vector<int> frames;
  for (int frame = 0; frame < 200; ++frame) {
    Eigen::Matrix3Xd positions = item.recording.markers.places.array() + 0.01 * frame;
    for (double& coordinate : positions.reshaped()) coordinate += noise(random);
    if (frame % 3 == 0) positions.col(4).setConstant(std::nan(""));
    item.recording.markers.positions.push_back(positions);
    item.recording.times.push_back(0.01 * frame);
    frames.push_back(frame);
  }
  // The median of 57 medians of 198 values each.
  EXPECT_NEAR(EstimateRecordingNoise(item, frames), kNoise, 0.05 * kNoise);
  EXPECT_EQ(EstimateRecordingNoise(item, {0, 1}), 0);
}

}  // namespace
}  // namespace lacuna
