// Fits of a calibration problem, from a distant start or from near the solution.
//
// All fits use the fitted frames of the fitted recordings. The correspondences of scanned points
// are fixed during a fit and updated after it, until the parameters settle. If they do not settle,
// the result is not usable. A fit that has used up its budget or its iterations is not usable
// either (Calibration::is_out_of_budget); its parameters are the best ones that it met. Where no
// fit from several starts has converged, the result is the one from the study's own start. All
// functions throw Interrupted.
#ifndef LACUNA_CALIBRATION_CALIBRATION_FITS_H_
#define LACUNA_CALIBRATION_CALIBRATION_FITS_H_

#include <Eigen/Core>

#include "calibration/calibration_problem.h"
#include "calibration/fit_store.h"
#include "core/progress.h"

namespace lacuna {

// How much work a fit may take, so that one that cannot succeed ends: a model that lacks what
// dominates the motion has no minimum near the noise, and would be searched from one start after
// another with ever shorter time steps. The unit is a prediction with the time step with which the
// budget began; one with half the step counts twice. Predictions that only judge start values or a
// time step count, too. The count, unlike a time limit, does not depend on the machine.
class FitBudget {
 public:
  // Four times what the longest of the bundled experiments takes. Larger: later giving up.
  static constexpr double kPredictions = 200;

  explicit FitBudget(double time_step) : time_step_(time_step) {}
  int PredictionsLeft(double time_step) const {
    return static_cast<int>(left_ * time_step / time_step_);
  }
  void Spend(int predictions, double time_step) { left_ -= predictions * time_step_ / time_step; }
  bool IsUsedUp(double time_step) const { return PredictionsLeft(time_step) < 1; }

 private:
  double time_step_;  // s
  double left_ = kPredictions;
};

// The end of the short horizon, in seconds after a recording's start: a quarter of the fitted time
// in which the object moves, taken from the recording in which that ends last.
double ShortHorizon(const CalibrationProblem& problem);

// `budget`, here and below: shared by several fits; null: each has one of its own. `kept`: finished
// parts are read from there and added to it, so that a fit that was stopped continues with the part
// that it was in; null: they are not kept.

// Fits over the short horizon, where a wrong model has the least time to diverge. Where `start` is
// that of a diagnosis (PredictionStudy::explained_misfit) and comes within kLocalMinimumSuspected
// over all fitted frames of markers, it is the result.
Calibration FitShortHorizon(const CalibrationProblem& problem, const Eigen::VectorXd& start,
                            Progress* progress, FitBudget* budget = nullptr,
                            FitStore* kept = nullptr);

// Fits over the short horizon first, then over all fitted frames.
Calibration FitInStages(const CalibrationProblem& problem, const Eigen::VectorXd& start,
                        Progress* progress);

// Fits all fitted frames at once, from near the solution.
Calibration RefineFit(const CalibrationProblem& problem, const Eigen::VectorXd& near,
                      Progress* progress, FitBudget* budget = nullptr, FitStore* kept = nullptr);

// Fits from the problem's start. A distant start may lead to a local minimum that is off by a
// period of a vibration: where the residual is far above the noise, the moduli are started from
// other values too and the best fit is kept. `beginning`: the fit over the short horizon, where it
// was made before.
Calibration FitFromStart(const CalibrationProblem& problem, Progress* progress,
                         const Calibration* beginning = nullptr, FitBudget* budget = nullptr,
                         FitStore* kept = nullptr);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_CALIBRATION_FITS_H_
