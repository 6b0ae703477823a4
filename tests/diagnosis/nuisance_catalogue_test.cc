#include "diagnosis/nuisance_catalogue.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "calibration/calibration_fits.h"
#include "calibration/calibration_problem.h"
#include "diagnosis/grip_motions.h"
#include "support/pulled_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// Everything that the rest of the program and the user may ask stands on every card.
TEST(NuisanceCatalogue, HasACompleteCardForEachNuisance) {
  std::set<std::string> names;
  for (const NuisanceEntry& entry : NuisanceCatalogue()) {
    const NuisanceCard& card = entry.card;
    EXPECT_TRUE(names.insert(card.name).second) << card.name << " stands in the list twice";
    for (const std::string& text : {card.name, card.title, card.directions, card.prior,
                                    card.residual_when_present, card.advice})
      EXPECT_FALSE(text.empty()) << card.name;
    EXPECT_NE(card.advice.back(), '.') << "the verdict continues the sentence";
    EXPECT_EQ(FindNuisance(card.name), &card);
    // Free directions of single frames follow any residual, and would be part of every model.
    if (card.is_always_in_model) {
      EXPECT_FALSE(card.acts_on_single_frames) << card.name;
    }
    const bool is_of_model = std::holds_alternative<ModelNuisance>(entry.make);
    EXPECT_EQ(card.is_always_in_model, is_of_model && card.name != "grip_extent" &&
                                           card.name != "load_scale" &&
                                           card.name != "recordings_differ")
        << card.name;
    if (std::holds_alternative<GripNuisance>(entry.make)) {
      EXPECT_EQ(card.source, NuisanceSource::kGrip) << card.name;
    }
    if (std::holds_alternative<RecordingNuisance>(entry.make)) {
      EXPECT_EQ(card.source, NuisanceSource::kMeasurement) << card.name;
    }
    if (card.shrinks_with_time_step) {
      EXPECT_EQ(card.source, NuisanceSource::kDiscretisation) << card.name;
    }
  }
  EXPECT_EQ(FindNuisance("gravity"), nullptr);
}

// The sealed trials refer to the controls by position and name; a case of a seed must not change.
TEST(NuisanceCatalogue, KeepsTheControlsOfTheTrialsInTheirOrder) {
  std::vector<std::string> controls;
  for (const NuisanceTrial& control : NuisanceControls()) {
    controls.push_back(control.control);
    EXPECT_GT(control.largest_clamp_error + control.element_volume + control.time_deviation +
                  control.frame_shift,
              0)
        << control.control << " disturbs nothing";
  }
  EXPECT_THAT(controls, testing::ElementsAre("grip", "bad_frame", "coarse_mesh", "time_jitter"));
}

// A marker in uniform motion, whose frames a clock, their own times or a drift may displace.
TEST(NuisanceCatalogue, MakesTheNuisancesOfARecordingFromItsFrames) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study = ReadBarStudy(folder.Path());
  const CalibrationProblem problem(study, BarMesh({6, 1, 1}, 2));
  const LinearisedMisfit misfit = problem.Linearise(problem.Start());
  ASSERT_TRUE(misfit.usable) << misfit.message;
  const LinearisedMisfit::Part& part = misfit.parts.front();
  const Eigen::Index frames = static_cast<Eigen::Index>(part.layout.times.size());
  Eigen::VectorXd residual = Eigen::VectorXd::Zero(misfit.residual.size());
  residual[part.first_row + 5 * part.layout.series] = 1;  // frame 5 is misplaced
  std::map<std::string, NuisanceCandidate> made;
  for (const NuisanceCandidate& nuisance : RecordingNuisances(problem, misfit, residual)) {
    ASSERT_EQ(nuisance.columns.rows(), misfit.residual.size()) << nuisance.card.name;
    ASSERT_EQ(nuisance.columns.cols(), static_cast<Eigen::Index>(nuisance.priors.size()));
    made[nuisance.card.name] = nuisance;
  }
  EXPECT_FALSE(made.contains("clock")) << "the study fits the clock";
  EXPECT_FALSE(made.contains("registration")) << "there is one recording";
  // The errors of all frames together are that of the clock.
  const Eigen::VectorXd all_late = made.at("time_jitter").columns.rowwise().sum();
  EXPECT_LT((all_late - part.speed).norm(), 1e-12 * part.speed.norm());
  EXPECT_EQ(made.at("time_jitter").columns.cols(), frames);
  EXPECT_TRUE(made.at("time_jitter").left_out.empty());
  const Eigen::MatrixXd& bad = made.at("bad_frame").columns;
  EXPECT_GT(bad.middleRows(5 * part.layout.series, part.layout.series).norm(), 0);
  EXPECT_EQ(bad.topRows(5 * part.layout.series).norm(), 0);
  EXPECT_DOUBLE_EQ(made.at("bad_frame").selection_penalty, std::log(static_cast<double>(frames)));
  // The drift is complete, 1 m per unit, in the last frame.
  const Eigen::MatrixXd& drift = made.at("registration_drift").columns;
  EXPECT_EQ(drift.topRows(part.layout.series).norm(), 0);
  EXPECT_DOUBLE_EQ(drift(drift.rows() - 3, 0), 1);
}

// Of two recordings, one of them a single frame and one with a fitted registration.
TEST(NuisanceCatalogue, ShiftsOneOfSeveralRecordings) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  PredictionStudy study = ReadBarStudy(folder.Path());
  PredictedRecording& other = study.recordings.emplace_back(study.recordings.front());
  other.name = "other";
  other.frames = {4};
  const auto shifted = [&] {
    const CalibrationProblem problem(study, BarMesh({3, 1, 1}, 1));
    const LinearisedMisfit misfit = problem.Linearise(problem.Start());
    EXPECT_TRUE(misfit.usable) << misfit.message;
    std::map<std::string, NuisanceCandidate> made;
    for (const NuisanceCandidate& nuisance : RecordingNuisances(problem, misfit, misfit.residual)) {
      if (nuisance.card.name != "registration") continue;
      made[nuisance.what] = nuisance;
      EXPECT_EQ(nuisance.columns.cols(), 6);
    }
    if (const auto found = made.find("the coordinate system of other"); found != made.end()) {
      const LinearisedMisfit::Part& part = misfit.PointsOf(1);
      EXPECT_EQ(found->second.columns.topRows(part.first_row).norm(), 0);
      EXPECT_EQ(found->second.columns(part.first_row + 1, 1), 1);
    }
    return made.size();
  };
  EXPECT_EQ(shifted(), 2u);
  study.recordings.front().shift_deviation = 1e-3;
  study.recordings.front().turn_deviation = 0.01;
  EXPECT_EQ(shifted(), 1u);
}

// A mass that is removed from a bar that has none cannot be predicted, and a sheet has no other
// mesh. What every model should contain must not vanish in silence.
TEST(NuisanceCatalogue, SaysWhatCannotBeSimulated) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  PredictionStudy study = ReadBarStudy(
      folder.Path(), {{"  - {type: mass_damping, alpha: 1 1/s}",
                       "  - {type: attached_mass, mass: 1 g, centre: [0.08 m, 0 m, 0 m]}"},
                      {"mass_damping.alpha", "attached_mass.mass"}});
  study.recordings.front().recording.reference.sheet_thickness = 1e-3;  // m
  const auto untried = [&] {
    const CalibrationProblem problem(study, BarMesh({3, 1, 1}, 1));
    Eigen::VectorXd values = problem.Start();
    const LinearisedMisfit misfit = problem.Linearise(values, {.with_jacobian = true});
    EXPECT_TRUE(misfit.usable) << misfit.message;
    values[1] = -1;  // kg
    std::vector<std::string> names;
    for (const NuisanceCandidate& nuisance :
         ModelNuisances({problem, values, misfit, GripMotions{}, Eigen::MatrixXd()})) {
      if (nuisance.untried.empty()) continue;
      EXPECT_EQ(nuisance.columns.rows(), misfit.residual.size()) << nuisance.card.name;
      EXPECT_EQ(nuisance.columns.cols(), 0) << nuisance.card.name;
      names.push_back(nuisance.card.name);
    }
    return names;
  };
  EXPECT_THAT(untried(), testing::ElementsAre("mesh", "time_step", "shape"));
  study.size_deviation = 0;  // the dimensions are exact: there is nothing to try
  EXPECT_THAT(untried(), testing::ElementsAre("mesh", "time_step"));
}

// A bar whose free part is shorter, with other elements than those of the column. What the
// parameters of the model follow does not count.
TEST(NuisanceCatalogue, ExtendsAGripLikeAShorterBar) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study = ReadBarStudy(folder.Path());
  const CalibrationProblem problem(study, BarMesh({6, 1, 1}, 2));
  SilentProgress progress;
  const Eigen::VectorXd values = FitInStages(problem, problem.Start(), &progress).parameters;
  const GripMotions grips = MakeGripMotions(problem);
  ASSERT_EQ(grips.grips.size(), 1u);
  const LinearisedMisfit misfit = problem.Linearise(values, {.with_jacobian = true});
  ASSERT_TRUE(misfit.usable) << misfit.message;
  Eigen::MatrixXd column;
  for (const NuisanceCandidate& nuisance :
       ModelNuisances({problem, values, misfit, grips, Eigen::MatrixXd()}))
    if (nuisance.card.name == "grip_extent") column = nuisance.columns;
  ASSERT_EQ(column.cols(), 1);

  constexpr double kFurther = 1e-4;
  const TetMesh whole = BarMesh({9, 1, 1}, 2);
  TetMesh shorter = whole;
  const double length = whole.nodes.row(0).maxCoeff();
  shorter.nodes.row(0) = (kFurther + (1 - kFurther / length) * whole.nodes.row(0).array()).matrix();
  const auto residual_on = [&](const TetMesh& mesh) {
    return CalibrationProblem(study, mesh).Linearise(values).residual;
  };
  const Eigen::VectorXd expected = residual_on(shorter) - residual_on(whole);
  ASSERT_EQ(expected.size(), column.rows());
  const auto beside_parameters = [&](const Eigen::VectorXd& change) -> Eigen::VectorXd {
    return change - misfit.jacobian * misfit.jacobian.colPivHouseholderQr().solve(change);
  };
  const Eigen::VectorXd left = beside_parameters(expected);
  EXPECT_LT(beside_parameters(kFurther * column.col(0) - expected).norm(), 0.2 * left.norm());
  // Beside what the parameters follow, little is left, so that the column can be multiplied.
  EXPECT_LT(left.norm(), 0.5 * expected.norm());
  EXPECT_LT(kFurther * column.norm(), 2 * left.norm());
}

// Two loads that are 1 % larger, against their column.
TEST(NuisanceCatalogue, ScalesAllMeasuredForcesAlike) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const auto study_with = [&](const std::string& first, const std::string& second) {
    std::ofstream(folder / "recording.yaml", std::ios::app) << fmt::format(
        "forces: [{{constant: [0, 0, {}], region: {{half_space: {{point: [40 mm, 0, 0], normal: "
        "[1, "
        "0, 0]}}}}}}, {{constant: [0, {}, 0], region: {{half_space: {{point: [60 mm, 0, 0], "
        "normal: "
        "[1, 0, 0]}}}}}}]\n",
        first, second);
    PredictionStudy study = ReadBarStudy(folder.Path());
    WriteBarRecording(folder.Path(), FilmHeldBar({}));
    return study;
  };
  const auto column_of = [](const PredictionStudy& study) {
    const CalibrationProblem problem(study, BarMesh({6, 1, 1}, 2));
    const LinearisedMisfit misfit = problem.Linearise(problem.Start(), {.with_jacobian = true});
    EXPECT_TRUE(misfit.usable) << misfit.message;
    for (const NuisanceCandidate& nuisance :
         ModelNuisances({problem, problem.Start(), misfit, GripMotions{}, Eigen::MatrixXd()}))
      if (nuisance.card.name == "load_scale") return Eigen::VectorXd(nuisance.columns.col(0));
    return Eigen::VectorXd();
  };
  const auto residual_of = [](const PredictionStudy& study) {
    const CalibrationProblem problem(study, BarMesh({6, 1, 1}, 2));
    return problem.Linearise(problem.Start()).residual;
  };
  EXPECT_EQ(column_of(ReadBarStudy(folder.Path())).size(), 0) << "nothing acts on the bar";
  const PredictionStudy study = study_with("20 mN", "-10 mN");
  const Eigen::VectorXd column = column_of(study);
  const Eigen::VectorXd change =
      (residual_of(study_with("20.2 mN", "-10.1 mN")) - residual_of(study)) / 0.01;
  ASSERT_EQ(column.size(), change.size());
  EXPECT_GT(change.norm(), 1e-4);
  EXPECT_LT((column - change).norm(), 0.02 * change.norm());
}

// A load cell shares the clock of its recording, but is no point that may be misplaced.
TEST(NuisanceCatalogue, OfARecordingWithALoadCellHaveItsRowsInTheClockOnly) {
  const TemporaryFolder folder;
  WritePulledBar(folder.Path(), {});
  const PredictionStudy study = ReadPulledBarStudy(folder.Path());
  const CalibrationProblem problem(study, BarMesh({6, 1, 1}, 2));
  const LinearisedWithGrips linearised = LineariseWithGrips(problem, problem.Start(), {});
  const LinearisedMisfit& misfit = linearised.misfit;
  ASSERT_TRUE(misfit.usable) << misfit.message;
  ASSERT_EQ(misfit.parts.size(), 2u);
  const LinearisedMisfit::Part& force = misfit.parts[1];
  const auto rows_of_force = [&](const Eigen::MatrixXd& columns) {
    return columns.middleRows(force.first_row, force.layout.Rows()).eval();
  };
  int recordings = 0;
  for (const NuisanceCandidate& nuisance : RecordingNuisances(problem, misfit, misfit.residual)) {
    const bool is_clock = nuisance.card.name == "clock";
    EXPECT_EQ(rows_of_force(nuisance.columns).norm() > 0, is_clock) << nuisance.card.name;
    if (is_clock) {
      EXPECT_EQ(rows_of_force(nuisance.columns), force.speed);
    }
    ++recordings;
  }
  EXPECT_GE(recordings, 3);
  // A jaw that yields to its force reads less.
  bool any = false;
  for (const NuisanceCandidate& nuisance : GripNuisances(linearised.grips, linearised.OfGrips()))
    any = any || (nuisance.card.name == "grip_compliance" &&
                  rows_of_force(nuisance.columns)(force.layout.Rows() - 1, 0) < 0);
  EXPECT_TRUE(any);
}

}  // namespace
}  // namespace lacuna
