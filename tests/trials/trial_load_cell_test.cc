// Sealed cases whose clamp has a load cell.
#include "trials/trial_load_cell.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "calibration/calibration_problem.h"
#include "effects/gravity.h"
#include "experiment/reference_body.h"
#include "prediction/predicted_body.h"
#include "prediction/prediction_study_reader.h"
#include "support/temporary_folder.h"
#include "trials/clamp_motion.h"
#include "trials/trial_simulation.h"
#include "trials/trial_suite.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TrialSuite Suite(const std::string& more) {
  return ReadTrialSuite(Config::Parse(
      "schema_version: 1\nname: cells\nseed: 11\ncontrols: 200\nhard_controls: 4\neffects: [drag]\n"
      "factors: [4]\nrecordings: [1]\nremoved: [drag]\n" +
          more,
      "cells.yaml"));
}

TEST(TrialLoadCells, LeaveEverythingElseOfACaseAsItIs) {
  const std::vector<TrialCase> before = CasesOf(Suite("")),
                               cases = CasesOf(Suite("load_cells: 0.25\n"));
  ASSERT_EQ(cases.size(), before.size());
  // Our own frozen number, from before suites had load cells, rounded to 0.01 Pa.
  EXPECT_NEAR(before[0].young_modulus, 62977.57, 0.01);
  int with = 0;
  for (size_t k = 0; k < cases.size(); ++k) {
    EXPECT_FALSE(before[k].load_cell.has_value());
    EXPECT_THAT(TextOfCase(before[k]), Not(HasSubstr("load_cell")));
    TrialCase without = cases[k];
    if (without.load_cell) {
      EXPECT_EQ(without.name, before[k].name + "-cell");
      EXPECT_THAT(TextOfCase(without), HasSubstr("load_cell"));
      ++with;
    }
    without.name = before[k].name;
    without.load_cell.reset();
    EXPECT_EQ(TextOfCase(without), TextOfCase(before[k]));
  }
  // A quarter of 206, with a standard deviation of 6.
  EXPECT_GT(with, 30);
  EXPECT_LT(with, 75);
}

TEST(TrialLoadCells, AreKeptWithTheCase) {
  const TemporaryFolder folder;
  TrialCase trial = DrawCase("kept", TrialGroup::kControl, 5, 1, false, "");
  trial.load_cell = DrawLoadCell(trial.seed, 1);
  ASSERT_TRUE(trial.load_cell.has_value());
  EXPECT_FALSE(DrawLoadCell(trial.seed, 0).has_value());
  WriteCase(trial, folder.Path());
  EXPECT_EQ(TextOfCase(ReadCase(folder.Path())), TextOfCase(trial));
}

TEST(TrialLoadCells, HaveErrorsThatAreDrawnFromTheirPriors) {
  constexpr int kDraws = 400;
  double tare = 0, delay = 0;
  for (uint64_t seed = 0; seed < kDraws; ++seed) {
    TrialCase trial;
    trial.seed = seed;
    trial.load_cell = DrawLoadCell(seed, 1);
    tare += (CellTare(trial, 0) / trial.load_cell->tare_deviation).squaredNorm() / 3 / kDraws;
    delay += std::pow(CellDelay(trial, 0) / trial.load_cell->delay_deviation, 2) / kDraws;
    EXPECT_NE(CellDelay(trial, 0), CellDelay(trial, 1));
  }
  // A mean of n squares of standard normal numbers is 1 ± √(2/n): ± 0.04 and ± 0.07.
  EXPECT_NEAR(tare, 1, 0.2);
  EXPECT_NEAR(delay, 1, 0.3);
}

// The clamp carries the weight of the bar and balances the hand until the release at 0.1 s; it
// moves from 0.25 s on.
TEST(TrialLoadCells, ReadTheForceOfTheClampLateWithAnOffset) {
  constexpr double kDelay = 0.004;  // s, and the time between two stamps of the motion
  TrialCase trial = DrawCase("late", TrialGroup::kControl, 5, 1, false, "");
  trial.load_cell = DrawLoadCell(trial.seed, 1);
  trial.load_cell->delay_deviation *= kDelay / CellDelay(trial, 0);
  std::vector<double> stamps = {0.05};
  for (int k = 0; k < 9; ++k) stamps.push_back(0.3 + kDelay * k);
  const std::vector<double> times = CellTimes(trial, 0, stamps);
  ASSERT_EQ(times.size(), stamps.size());
  TrialProcedure procedure{{0.05, 0.31, 0.33},
                           [](double time) { return ClampMotionAt(0, time).Place(); },
                           trial.hold_forces[0],
                           {},
                           times};
  const TrueMotion motion = SimulateTruth(trial, procedure, /*rough=*/true);
  procedure.cell_times = stamps;
  const TrueMotion prompt = SimulateTruth(trial, procedure, /*rough=*/true);
  ASSERT_EQ(motion.positions.size(), procedure.times.size());
  ASSERT_EQ(motion.forces.cols(), static_cast<Eigen::Index>(stamps.size()));
  const double weight = kTrialDensity * trial.true_size.prod() * kStandardGravity;
  const Eigen::Vector3d balance = Eigen::Vector3d(0, 0, weight) - trial.hold_forces[0];
  // The mesh fills the box, and the equilibrium is known to far less than 1 % of the forces.
  EXPECT_LT((motion.forces.col(0) - balance).norm(), 0.01 * balance.norm());
  // The same simulation at the same times, up to rounding; at the times of the stamps the forces
  // differ by more than a thousand times that.
  const Eigen::Matrix3Xd late = motion.forces.rightCols(8);
  EXPECT_LT((late - prompt.forces.middleCols(1, 8)).lpNorm<Eigen::Infinity>(), 1e-6);
  EXPECT_GT((late - prompt.forces.rightCols(8)).colwise().norm().mean(), 1e-3);

  const MeasuredReaction reading = CellReading(trial, 0, stamps, motion.forces);
  const Eigen::Matrix3Xd errors = (reading.values - motion.forces).colwise() - CellTare(trial, 0);
  // The rms of 30 normal numbers is 1 ± 0.13.
  EXPECT_NEAR(std::sqrt(errors.squaredNorm() / 30) / trial.load_cell->deviation, 1, 0.5);
}

TEST(TrialLoadCells, AreInTheRecordingsOfACaseWhoseMarkersStay) {
  const TemporaryFolder folder;
  TrialCase trial = DrawCase("with", TrialGroup::kControl, 5, 1, false, "");
  SimulateCase(trial, folder / "without", /*rough=*/true);
  trial.load_cell = DrawLoadCell(trial.seed, 1);
  SimulateCase(trial, folder / "with", /*rough=*/true);
  EXPECT_EQ(FileContent(folder / "with/recording_1/markers.csv"),
            FileContent(folder / "without/recording_1/markers.csv"));
  EXPECT_THAT(FileContent(folder / "without/recording_1/recording.yaml"),
              Not(HasSubstr("measured_force")));
  const PredictionStudy study = ReadPredictionStudy(Config::Load(folder / "with/experiment.yaml"));
  const std::vector<MeasuredReaction>& readings = study.recordings.at(0).recording.object.reactions;
  ASSERT_EQ(readings.size(), 1u);
  EXPECT_EQ(readings[0].name, "clamp");
  EXPECT_NEAR(readings[0].deviation, trial.load_cell->deviation, 1e-12);
  EXPECT_NEAR(readings[0].tare_deviation, trial.load_cell->tare_deviation, 1e-12);
  EXPECT_NEAR(readings[0].delay_deviation, trial.load_cell->delay_deviation, 1e-12);
  EXPECT_EQ(readings[0].values.cols(), kTrialFrames);
  const CalibrationProblem problem(study, MakeReferenceBody(study).mesh);
  // Modulus, Poisson's ratio, damping, three components of the hand's force, and the delay.
  ASSERT_EQ(problem.Start().size(), 7);
  EXPECT_THAT(problem.parameters().back().name, HasSubstr("clamp.force_delay"));
}

TEST(TrialLoadCells, AreCountedInTheDetectableSizeOfAHiddenEffect) {
  const TemporaryFolder folder;
  TrialSuite suite = Suite("load_cells: 1\n");
  suite.controls = suite.hard_controls = 0;
  suite.removed.clear();
  const std::vector<TrialCase> cases = CasesOf(suite);
  ASSERT_EQ(cases.size(), 1u);
  ASSERT_TRUE(MakeCase(cases[0], folder.Path()));
  const std::filesystem::path own = folder / cases[0].name;
  const TrialCase sealed = ReadCase(own);
  ASSERT_TRUE(sealed.load_cell.has_value());
  const double size = sealed.hidden.at(0).parameters.at("coefficient");
  EXPECT_GT(size, 0.1);  // kg/m³; air has about 1
  EXPECT_THAT(FileContent(own / "recording_1/recording.yaml"), HasSubstr("measured_force"));
  // Without the force, the same effect in the same bar must be larger to be as visible.
  TrialCase blind = cases[0];
  blind.name = "blind";
  blind.load_cell.reset();
  ASSERT_TRUE(MakeCase(blind, folder.Path()));
  const TrialCase without = ReadCase(folder / blind.name);
  ASSERT_EQ(without.seed, sealed.seed) << "one of the two cases was drawn again";
  EXPECT_GT(without.hidden.at(0).parameters.at("coefficient"), size);
}

}  // namespace
}  // namespace lacuna
