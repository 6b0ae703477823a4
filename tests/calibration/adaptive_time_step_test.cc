// A fit that finds out how short its steps must be.
#include "calibration/adaptive_time_step.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"
#include "support/test_effect.h"

namespace lacuna {
namespace {

const std::map<std::string, std::string> kWithoutStep{{"motion: {time_step: 1.5 ms}\n", ""}};

class AdaptiveTimeStepOfABar : public testing::Test {
 protected:
  AdaptiveTimeStepOfABar() { WriteBarRecording(folder_.Path(), FilmHeldBar(truth_)); }

  AdaptedFit Fit(PredictionStudy* study) const {
    SilentProgress progress;
    return FitWithAdaptiveTimeStep(BarMesh({8, 2, 2}, 2), study, &progress);
  }

  TemporaryFolder folder_;
  const HeldBarTruth truth_;
};

TEST_F(AdaptiveTimeStepOfABar, ShortensTheStepUntilItHardlyMatters) {
  PredictionStudy study = ReadBarStudy(folder_.Path(), kWithoutStep);
  EXPECT_TRUE(study.chooses_time_step);
  EXPECT_EQ(study.time_step, 0.005);  // half the distance of the frames
  const AdaptedFit fit = Fit(&study);
  ASSERT_TRUE(fit.calibration.usable) << fit.calibration.message;
  EXPECT_LT(study.time_step, 0.004);
  EXPECT_GT(study.time_step, 0.0005);
  EXPECT_GT(fit.step_error, 0);
  EXPECT_LT(fit.step_error, 0.2);
  EXPECT_EQ(fit.note, "");

  PredictionStudy coarse =
      ReadBarStudy(folder_.Path(), {{"motion: {time_step: 1.5 ms}", "motion: {time_step: 5 ms}"}});
  const AdaptedFit with_coarse = Fit(&coarse);
  EXPECT_EQ(coarse.time_step, 0.005);  // as it was told
  EXPECT_EQ(with_coarse.step_error, 0);
  EXPECT_LT(fit.calibration.rms, with_coarse.calibration.rms);
  EXPECT_LT(std::abs(fit.calibration.parameters[0] / truth_.young_modulus - 1),
            std::abs(with_coarse.calibration.parameters[0] / truth_.young_modulus - 1));
}

TEST_F(AdaptiveTimeStepOfABar, DoesNotResolveWhatTheModelLacksAnyway) {
  PredictionStudy study = ReadBarStudy(
      folder_.Path(),
      {{"motion: {time_step: 1.5 ms}\n", ""},
       {"fit: {parameters: [{name: young_modulus}, {name: mass_damping.alpha}]}",
        "fit: {parameters: []}"},
       {"noise: 0.05 mm", "noise: 0.0005 mm"},
       {"young_modulus: 0.15 MPa", "young_modulus: 0.05 MPa"}});  // half of the truth's
  const AdaptedFit fit = Fit(&study);
  EXPECT_GT(fit.calibration.rms, 100);
  EXPECT_GT(fit.step_error, 1);
  EXPECT_LT(fit.step_error, 0.05 * fit.calibration.rms);
}

// The noise hides the error of the first step, which therefore stays. Each of the two estimates of
// that error takes one prediction with the step and one with half of it, which counts twice; one
// more prediction judges the start values.
TEST_F(AdaptiveTimeStepOfABar, CountsWhatJudgesTheStep) {
  PredictionStudy study = ReadBarStudy(
      folder_.Path(), {{"motion: {time_step: 1.5 ms}\n", ""}, {"noise: 0.05 mm", "noise: 5 mm"}});
  const double step = study.time_step;
  FitBudget budget(step);
  SilentProgress progress;
  const AdaptedFit fit =
      FitWithAdaptiveTimeStep(BarMesh({3, 1, 1}, 1), &study, &progress, nullptr, &budget);
  ASSERT_TRUE(fit.calibration.usable) << fit.calibration.message;
  ASSERT_EQ(study.time_step, step);
  EXPECT_GT(fit.step_error, 0);
  EXPECT_EQ(budget.PredictionsLeft(step),
            FitBudget::kPredictions - fit.calibration.predictions - 2 * (1 + 2) - 1);
}

// A force whose direction changes with each halving of the step: no step is short enough.
class StepDependentForce final : public TestEffect<StepDependentForce> {
 public:
  static constexpr double kFirstStep = 0.005;  // s

  static constexpr const char* kType = "step_dependent_force";
  void AddForce(const Kinematics& at, Eigen::VectorXd* force) const override {
    constexpr double kAcceleration = 20;  // m/s²
    if (at.time_step == 0) return;
    const auto halvings = std::lround(std::log2(kFirstStep / at.time_step));
    force->reshaped(3, at.body.NodeCount()).row(2) +=
        (halvings % 2 == 0 ? kAcceleration : -kAcceleration) * at.body.node_mass.transpose();
  }
};

PredictionStudy WithoutAStepThatIsShortEnough(const std::filesystem::path& folder) {
  PredictionStudy study = ReadBarStudy(
      folder, {{"motion: {time_step: 1.5 ms}\n", ""},
               {"fit: {parameters: [{name: young_modulus}, {name: mass_damping.alpha}]}",
                "fit: {parameters: []}"},
               {"fit_until: 0.1501 s", "fit_until: 0.0801 s"},
               {"    clock_deviation: 10 ms\n", ""}});
  EXPECT_EQ(study.time_step, StepDependentForce::kFirstStep);
  study.effects.push_back(std::make_shared<const StepDependentForce>());
  return study;
}

// Two estimates of the error of a step take six predictions.
TEST_F(AdaptiveTimeStepOfABar, EndsWhereItsEstimatesHaveUsedUpTheBudget) {
  PredictionStudy study = WithoutAStepThatIsShortEnough(folder_.Path());
  constexpr int kLeft = 8;  // predictions
  FitBudget budget(study.time_step);
  budget.Spend(static_cast<int>(FitBudget::kPredictions) - kLeft, study.time_step);
  SilentProgress progress;
  const AdaptedFit fit =
      FitWithAdaptiveTimeStep(BarMesh({3, 1, 1}, 1), &study, &progress, nullptr, &budget);
  EXPECT_THAT(fit.note, testing::HasSubstr("the predictions that a fit may take are used up"));
  EXPECT_GE(study.time_step, StepDependentForce::kFirstStep / 4) << "shortened once at most";
  EXPECT_TRUE(budget.IsUsedUp(StepDependentForce::kFirstStep));
}

TEST_F(AdaptiveTimeStepOfABar, SaysWhereNoStepIsShortEnough) {
  PredictionStudy study = WithoutAStepThatIsShortEnough(folder_.Path());
  SilentProgress progress;
  const AdaptedFit fit = FitWithAdaptiveTimeStep(BarMesh({3, 1, 1}, 1), &study, &progress);
  ASSERT_FALSE(fit.calibration.estimates.empty()) << fit.calibration.message;
  EXPECT_GT(fit.step_error, 0.2);
  EXPECT_THAT(fit.note, testing::HasSubstr("may be too long: half of it would change the fitted "
                                           "frames by"));
  // Each step is a quarter of the last one, so that the budget, of 200 predictions with the first
  // one, ends before the number of step lengths does.
  EXPECT_THAT(fit.note, testing::HasSubstr("the predictions that a fit may take are used up"));
  EXPECT_THAT(fit.note, testing::HasSubstr("motion.time_step gives a shorter one"));
}

}  // namespace
}  // namespace lacuna
