// Fits that run out of their budget.
#include "calibration/calibration_fits.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

TEST(FitBudget, CountsPredictionsByTheLengthOfTheirSteps) {
  constexpr double kStep = 2e-3;  // s
  FitBudget budget(kStep);
  EXPECT_EQ(budget.PredictionsLeft(kStep), FitBudget::kPredictions);
  EXPECT_EQ(budget.PredictionsLeft(kStep / 4), FitBudget::kPredictions / 4);
  budget.Spend(10, kStep);
  budget.Spend(10, kStep / 2);
  EXPECT_EQ(budget.PredictionsLeft(kStep), FitBudget::kPredictions - 30);
  budget.Spend(static_cast<int>(FitBudget::kPredictions) - 31, kStep);
  EXPECT_FALSE(budget.IsUsedUp(kStep));
  EXPECT_TRUE(budget.IsUsedUp(kStep / 2)) << "one with half of the step costs two";
}

class FitOutOfBudget : public testing::Test {
 protected:
  static constexpr int kLeft = 5;          // predictions, too few for the modulus to be found
  static constexpr int kMost = kLeft + 1;  // as the derivatives at the end may take one more

  static PredictionStudy StudyIn(const std::filesystem::path& folder) {
    WriteBarRecording(folder, FilmHeldBar({}));
    return ReadBarStudy(folder);
  }
  // A budget of which kLeft predictions are left.
  FitBudget Left() const {
    FitBudget budget(study_.time_step);
    budget.Spend(static_cast<int>(FitBudget::kPredictions) - kLeft, study_.time_step);
    return budget;
  }
  // The rms of the residual at these values over the frames that are fitted.
  double RmsAt(const Eigen::VectorXd& values) const {
    return RootMeanSquare(problem_.Predict(values, false));
  }

  void ExpectUnusableButBetter(const Calibration& fit, const Eigen::VectorXd& start) const {
    EXPECT_FALSE(fit.usable);
    EXPECT_TRUE(fit.is_out_of_budget);
    EXPECT_FALSE(fit.message.empty());
    ASSERT_EQ(fit.parameters.size(), start.size());
    EXPECT_LT(fit.rms, 0.9 * RmsAt(start));
    // What the frames are compared with was fixed at the start of the fit.
    EXPECT_NEAR(RmsAt(fit.parameters), fit.rms, 0.03 * fit.rms);
  }

  TemporaryFolder folder_;
  SilentProgress progress_;
  const PredictionStudy study_ = StudyIn(folder_.Path());
  const CalibrationProblem problem_{study_, BarMesh({3, 1, 1}, 2)};
};

TEST_F(FitOutOfBudget, HasTheBestParametersThatItMet) {
  FitBudget budget = Left();
  const Calibration fit = RefineFit(problem_, problem_.Start(), &progress_, &budget);
  ExpectUnusableButBetter(fit, problem_.Start());
  EXPECT_LE(fit.predictions, kMost);
  EXPECT_TRUE(budget.IsUsedUp(study_.time_step));
}

// The moduli are not started from other values then, as after a fit that fails otherwise.
TEST_F(FitOutOfBudget, EndsTheStagesOfAFitFromTheStart) {
  Calibration beginning;
  beginning.usable = true;
  beginning.parameters = problem_.Start();
  FitBudget budget = Left();
  const Calibration fit = FitFromStart(problem_, &progress_, &beginning, &budget);
  ExpectUnusableButBetter(fit, problem_.Start());
  EXPECT_NEAR(fit.start_rms, RmsAt(problem_.Start()), 1e-3 * fit.start_rms);
  EXPECT_LE(fit.predictions, kMost);
  EXPECT_TRUE(budget.IsUsedUp(study_.time_step));
}

// The prediction at the start values, which start_rms needs, counts as well.
TEST_F(FitOutOfBudget, CountsThePredictionAtTheStartValues) {
  Calibration beginning;
  beginning.usable = true;
  beginning.parameters = problem_.Start();
  FitBudget ample(study_.time_step);
  const Calibration fit = FitFromStart(problem_, &progress_, &beginning, &ample);
  ASSERT_TRUE(fit.usable) << fit.message;
  ASSERT_FALSE(ample.IsUsedUp(study_.time_step));
  EXPECT_EQ(ample.PredictionsLeft(study_.time_step), FitBudget::kPredictions - fit.predictions - 1);
}

// A first part over which the body hardly deforms can end at any modulus.
TEST(FitFromStart, IsNotWorseThanItsStart) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study = ReadBarStudy(
      folder.Path(), {{"young_modulus: 0.15 MPa", "young_modulus: 0.1 MPa"}, {"1 1/s", "2 1/s"}});
  const CalibrationProblem problem(study, BarMesh({3, 1, 1}, 2));
  Calibration astray;
  astray.parameters = problem.Start();
  astray.parameters[0] = 1e9;  // Pa
  SilentProgress progress;
  const Calibration fit = FitFromStart(problem, &progress, &astray);
  EXPECT_TRUE(fit.usable) << fit.message;
  EXPECT_LE(fit.rms, fit.start_rms);
  EXPECT_NEAR(fit.parameters[0], 1e5, 2e4);
}

}  // namespace
}  // namespace lacuna
