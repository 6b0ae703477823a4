// Forces that load cells measure on driven grips, as data of a fit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "calibration/calibration_problem.h"
#include "calibration/calibration_run.h"
#include "calibration/data_shares.h"
#include "calibration/held_out_misfit.h"
#include "calibration/linear_misfit.h"
#include "calibration/reaction_report.h"
#include "effects/catalogue.h"
#include "prediction/prediction_study_reader.h"
#include "record/csv_table.h"
#include "support/pulled_bar.h"
#include "support/silent_fit.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// A pulled bar that was recorded in a folder of its own, and the fit of its modulus.
struct FittedBar {
  explicit FittedBar(const PulledBarTruth& truth, const std::string& measured_force = kLoadCell,
                     const std::string& measured_torque = "")
      : study(Record(folder.Path(), truth, measured_force, measured_torque)),
        problem(study, PulledBarMesh()),
        fit(FitSilently(problem)) {}

  std::vector<RecordingMisfit> Misfits() const { return MisfitsOf(problem, fit.parameters); }

  TemporaryFolder folder;
  PredictionStudy study;
  CalibrationProblem problem;
  Calibration fit;

 private:
  static PredictionStudy Record(const std::filesystem::path& folder, const PulledBarTruth& truth,
                                const std::string& measured_force,
                                const std::string& measured_torque) {
    WritePulledBar(folder, truth, measured_force, measured_torque);
    return ReadPulledBarStudy(folder);
  }
};

// The truth lies in the interval of the estimate, which is narrower than `width`.
void ExpectFound(const ParameterEstimate& estimate, double truth, double width) {
  EXPECT_EQ(estimate.determination, Determination::kPinnedDown);
  EXPECT_LT(estimate.low, truth);
  EXPECT_GT(estimate.high, truth);
  EXPECT_LT(estimate.high - estimate.low, width);
}

TEST(MeasuredForce, DeterminesTheModulusOfABarThatIsStretched) {
  const PulledBarTruth truth;
  const FittedBar bar(truth);
  const Calibration& fit = bar.fit;
  ASSERT_TRUE(fit.usable) << fit.message;
  // 12 readings with σ = 10 mN and an unknown tare: the slope over 0 to 5.5 mm, of about 3 N, is
  // known to σ √(12/12) / 3 N = 0.3 %.
  ExpectFound(fit.estimates.at(0), truth.young_modulus, 0.03 * truth.young_modulus);
  EXPECT_LT(fit.rms, 1.2);

  const std::vector<RecordingMisfit> misfits = bar.Misfits();
  const FittedReaction& jaw = misfits.at(0).reactions.at(0);
  EXPECT_EQ(jaw.name, "jaw");
  EXPECT_EQ(jaw.in_fit.frames, 12);
  EXPECT_EQ(jaw.held_out.frames, kPulledFrames - 12);
  // The tare is predicted minus measured.
  EXPECT_NEAR(jaw.tare.at(0), -truth.tare, 0.02);
  EXPECT_LT(jaw.in_fit.rms_over_sigma, 1.5);
  EXPECT_LT(jaw.held_out.rms_over_sigma, 3);  // the errors of modulus and tare included
  EXPECT_GT(jaw.held_out.rms, 0);
  // The motion of the markers hardly depends on the modulus.
  EXPECT_GT(SharesOfData(bar.problem, fit.parameters).at(0).value().forces, 0.999);

  // A prediction that is known is not made again.
  const LinearisedMisfit known = bar.problem.Linearise(fit.parameters);
  const FittedReaction same = MisfitsOf(bar.problem, fit.parameters, &known).at(0).reactions.at(0);
  EXPECT_NEAR(same.in_fit.rms, jaw.in_fit.rms, 1e-6 * jaw.in_fit.rms);
  EXPECT_NEAR(same.held_out.rms, jaw.held_out.rms, 1e-6 * jaw.held_out.rms);
}

// A motion that is given at both ends, without gravity, is the same for every modulus.
TEST(MeasuredForce, WithoutItTheModulusScalesOut) {
  const FittedBar bar({}, "");
  ASSERT_EQ(bar.fit.estimates.size(), 1u);
  const Determination determination = bar.fit.estimates[0].determination;
  EXPECT_TRUE(determination == Determination::kFlat || determination == Determination::kDead)
      << static_cast<int>(determination);
  EXPECT_TRUE(SharesOfData(bar.problem, bar.fit.parameters).empty());
}

// The torque of a jaw that twists and pulls determines the modulus as its force does.
TEST(MeasuredTorque, DeterminesTheModulusOfABarThatIsTwisted) {
  PulledBarTruth truth;
  truth.twist = 0.02;
  const FittedBar bar(
      truth, "",
      "{file: force.csv, time: t, along: [1, 0, 0], value: mx, about: [0 m, 0 m, 0 m], deviation: "
      "0.01 N mm}");
  ASSERT_TRUE(bar.fit.usable) << bar.fit.message;
  ExpectFound(bar.fit.estimates.at(0), truth.young_modulus, 0.05 * truth.young_modulus);
  const std::vector<RecordingMisfit> misfits = bar.Misfits();
  const FittedReaction& jaw = misfits.at(0).reactions.at(0);
  EXPECT_TRUE(jaw.is_torque);
  EXPECT_LT(jaw.in_fit.rms_over_sigma, 1.5);
  EXPECT_GT(SharesOfData(bar.problem, bar.fit.parameters).at(0).value().forces, 0.99);
  // The curve is in the table of torques, over the rotation of the jaw.
  EXPECT_TRUE(ReactionTable(bar.problem, misfits, /*torques=*/false).empty());
  const CsvTable curve = ReactionTable(bar.problem, misfits, /*torques=*/true);
  EXPECT_EQ(curve.at(6).name, "rotation_rad");
  EXPECT_NEAR(curve[6].values[10], 10 * truth.twist, 1e-12);
}

// A load cell that is late and of which the sign is not known.
TEST(MeasuredForce, MayBeLateAndOfUnknownSign) {
  PulledBarTruth truth;
  truth.tare = 0;
  truth.delay = 0.7;
  truth.sign = -1;
  const FittedBar bar(truth,
                      "{file: force.csv, time: t, x: fx, deviation: 10 mN, exerted_by: unknown, "
                      "delay_deviation: 1 s}");
  const Calibration& fit = bar.fit;
  ASSERT_TRUE(fit.usable) << fit.message;
  ASSERT_EQ(fit.estimates.size(), 2u);
  EXPECT_LT(fit.estimates[0].low, truth.young_modulus);
  EXPECT_GT(fit.estimates[0].high, truth.young_modulus);
  const std::string& name = bar.problem.parameters().at(1).name;
  EXPECT_NE(name.find("jaw.force_delay"), std::string::npos) << name;
  // The force grows by 0.23 N/s, so that 11 readings of 10 mN give the delay to about 30 ms.
  const ParameterEstimate& delay = fit.estimates[1];
  EXPECT_LT(delay.low, truth.delay);
  EXPECT_GT(delay.high, truth.delay);
  EXPECT_LT(delay.high - delay.low, 0.3);
  EXPECT_LT(fit.rms, 1.2);
  const FittedReaction jaw = bar.Misfits().at(0).reactions.at(0);
  EXPECT_TRUE(jaw.is_opposite);
  EXPECT_LT(jaw.held_out.rms_over_sigma, 3);
  const LinearisedMisfit known = bar.problem.Linearise(fit.parameters);
  EXPECT_TRUE(MisfitsOf(bar.problem, fit.parameters, &known).at(0).reactions.at(0).is_opposite);
}

// The rows of a force and of a torque beside those of the markers: their layout and errors, and
// their derivatives by all parameters, which agree with central differences of the rows.
TEST(MeasuredForce, ItsRowsAndSensitivitiesAgreeWithDifferences) {
  const TemporaryFolder folder;
  PulledBarTruth truth;
  truth.twist = 0.02;
  WritePulledBar(folder.Path(), truth, kLoadCell,
                 "{file: force.csv, time: t, x: mx, deviation: 0.01 N mm, delay_deviation: 0.1 s}");
  const PredictionStudy study = ReadPulledBarStudy(
      folder.Path(), {{"{name: young_modulus}", "{name: young_modulus}, {name: poisson_ratio}"},
                      {"    fit_until: 11.5 s\n",
                       "    clock_deviation: 0.1 s\n    registration: {shift_deviation: 1 mm, "
                       "turn_deviation: 1 deg}\n"}});
  const CalibrationProblem problem(study, PulledBarMesh());
  Eigen::VectorXd at = problem.Start();
  ASSERT_EQ(at.size(), 10);
  at.tail(8) << 0.05, -0.3, 1e-3, -2e-3, 1e-3, 5e-4, -3e-4, 2e-4;
  const Eigen::VectorXd steps =
      (Eigen::VectorXd(10) << 200, 1e-3, 1e-3, 1e-3, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4).finished();
  // An effect that the model lacks, which a diagnosis would try.
  const std::shared_ptr<const Effect> gravity = MakeEffect("gravity", {{"acceleration_x", 0.0}});
  const LinearisedMisfit here = problem.Linearise(
      at, {.with_jacobian = true,
           .directions = {{.perturbation = {.effect = gravity, .parameter = 0}}}});
  ASSERT_TRUE(here.usable) << here.message;
  ASSERT_EQ(here.parts.size(), 3u);
  const LinearisedMisfit::Part& torque = here.parts[2];
  EXPECT_TRUE(here.parts[0].IsOfPoints());
  const LinearisedMisfit::Part& force = here.parts[1];
  ASSERT_EQ(force.reaction, std::optional<size_t>(0));
  EXPECT_EQ(force.layout.Rows(), kPulledFrames);
  EXPECT_EQ(force.errors.noise, 0.01);
  EXPECT_EQ(force.errors.common, 0.3);
  for (Eigen::Index k = 0; k < at.size(); ++k) {
    const Eigen::VectorXd shift = steps[k] * Eigen::VectorXd::Unit(at.size(), k);
    const Eigen::VectorXd difference =
        (problem.Linearise(at + shift, {.correspondences = &here}).residual -
         problem.Linearise(at - shift, {.correspondences = &here}).residual) /
        (2 * steps[k]);
    for (const LinearisedMisfit::Part* part : {&force, &torque}) {
      // With these delays the last reading of the torque lies beyond the path of the grip, and its
      // rate is the mean over a step across the end of the path.
      const Eigen::Index beyond = part == &torque && (k == 2 || k == 3) ? 1 : 0;
      const auto rows = [&](const Eigen::VectorXd& all) {
        return all.segment(part->first_row, part->layout.Rows() - beyond);
      };
      // Equilibria are known to 1e-6 of the forces. The rate, for the delays, is the mean over a
      // step between two frames, in which the curve bends by 1 %.
      const double tolerance = k == 2 || k == 3 ? 1e-2 : 1e-3;
      // The delay of the torque changes at which times equilibria are sought before.
      const double least = part == &torque ? 1e-12 : k == 3 ? 1e-6 : 1e-9;
      EXPECT_LT((rows(here.jacobian.col(k)) - rows(difference)).norm(),
                tolerance * rows(difference).norm() + least)
          << k << ": " << rows(here.jacobian.col(k)).transpose() << "\nagainst "
          << rows(difference).transpose();
      // The registration of the markers does not concern the load cells, and the delay of one of
      // them not the other.
      if (k >= 4 || (k == 3 && part == &force)) {
        EXPECT_EQ(rows(here.jacobian.col(k)).norm(), 0) << k;
      }
    }
  }
  // The weight of the bar is carried by both ends; a column of a candidate has the row of the jaw.
  const double mass = problem.body()->node_mass.sum();
  const double by_gravity = here.jacobian(force.first_row, at.size());
  EXPECT_NEAR(by_gravity, -0.5 * mass, 0.05 * mass);
  // The whitened rows of all frames, in the same order, are what is fitted.
  const ResidualEvaluation fitted = problem.Predict(at, true);
  ASSERT_TRUE(fitted.usable) << fitted.message;
  const Eigen::MatrixXd white =
      WhitenedRows(here.jacobian.leftCols(at.size()), here, {.fitted_only = true});
  ASSERT_EQ(fitted.jacobian.rows(), white.rows());
  EXPECT_LT((fitted.jacobian - white).norm(), 1e-6 * fitted.jacobian.norm());
  ASSERT_EQ(static_cast<Eigen::Index>(fitted.before.size()), white.rows());
  EXPECT_EQ(fitted.before[static_cast<size_t>(force.first_row)], -1);
  EXPECT_EQ(fitted.before.back(), white.rows() - 2);
}

TEST(MeasuredForce, ARunKeepsItsErrorsAndItsCurve) {
  const TemporaryFolder folder;
  // The noise is estimated: the rows of a file that says nothing scatter by 10 mN.
  WritePulledBar(folder.Path(), {},
                 "{file: force.csv, time: t, along: [2, 0, 0], value: fx, tare_deviation: 0.3 N}");
  std::ofstream(folder / "study.yaml") << PulledBarExperiment(folder.Path());
  SilentProgress progress;
  const CalibrationRecord record =
      RunCalibration(ReadPredictionStudy(Config::Load(folder / "study.yaml")), &progress);
  ASSERT_TRUE(record.usable) << record.message;
  const CalibrationRecord read = ReadCalibration(folder / "run");
  const FittedReaction& jaw = read.recordings.at(0).reactions.at(0);
  EXPECT_TRUE(jaw.deviation_is_estimated);
  EXPECT_GT(jaw.deviation, 0.004);  // from 16 readings
  EXPECT_LT(jaw.deviation, 0.025);
  EXPECT_THAT(jaw.labels, testing::ElementsAre("along"));
  EXPECT_EQ(jaw.in_fit.rms, record.recordings[0].reactions.at(0).in_fit.rms);
  EXPECT_GT(read.parameters.at(0).shares.value().forces, 0.99);

  const CsvTable curve = ReadCsv(folder / "run/calibration/reactions.csv");
  ASSERT_EQ(curve.size(), 9u);
  ASSERT_EQ(curve[0].values.size(), kPulledFrames);
  EXPECT_EQ(curve[6].name, "displacement_m");
  EXPECT_NEAR(curve[6].values[15], 15 * kStretch, 1e-12);
  EXPECT_EQ(curve[8].name, "difference_N");
  EXPECT_LT(curve[8].values.cwiseAbs().maxCoeff(), 0.1);
}

TEST(MeasuredForce, NeedsAReadingWithinTheFramesAndItsNoise) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& content) -> std::string {
    WritePulledBar(folder.Path(), {}, "{file: force.csv, time: t, x: fx}");
    std::ofstream(folder / "force.csv") << content;
    try {
      ReadPulledBarStudy(folder.Path());
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing was refused";
  };
  EXPECT_THAT(message("t,fx\n100,1\n200,2\n"), testing::HasSubstr("in which no frame lies"));
  EXPECT_THAT(message("t,fx\n0,1\n5,1\n15,1\n"),
              testing::HasSubstr("deviation: cannot be estimated"));
}

}  // namespace
}  // namespace lacuna
