// The error of the time step of a prediction, by Richardson's extrapolation.
//
// With the residuals r, r½ and r¼ for the step h, h/2 and h/4, the extrapolation to h → 0 is
// r¼ + (r¼ − r½)/(p − 1), where p is the factor by which the change falls with each halving
// (Richardson, Phil. Trans. A 210, 1911). A scheme of first order may converge with second order,
// and effects with memory may reduce the order, so p is the observed one (Roache, Verification and
// Validation in Computational Science and Engineering, 1998), of the whitened residuals, between
// that of the scheme and second order. Of quasi-static steps, h is at most the longest distance
// between frames, at which such steps end.
#ifndef LACUNA_CALIBRATION_STEP_ERRORS_H_
#define LACUNA_CALIBRATION_STEP_ERRORS_H_

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "calibration/calibration_problem.h"

namespace lacuna {

// Changes of the rows of a linearised misfit, m.
struct StepErrors {
  // The extrapolation is known to this share of its change, and the departure to this share of
  // itself. Calibrated on bars with a second-order scheme: 1/16 of the step was off the limit by
  // 0.1 of that departure in eight bars, and by 0.6 in two that vibrate in modes which no step
  // resolves. Higher: wider intervals, and more evidence is asked of an effect.
  static constexpr double kLimitDeviation = 0.05, kDepartureDeviation = 0.7;

  Eigen::VectorXd to_limit;   // with infinitely short steps
  Eigen::VectorXd departure;  // of the two halvings from the factor p

  // One standard deviation of what is not known about the change to the limit.
  Eigen::VectorXd Unknown() const { return kDepartureDeviation * departure; }
};

// `misfit` is that at `values`; `on_frame` is LineariseOptions::on_frame of the predictions.
// Nothing if a prediction with a shorter step fails. Throws Interrupted.
std::optional<StepErrors> FindStepErrors(const CalibrationProblem& problem,
                                         const Eigen::VectorXd& values,
                                         const LinearisedMisfit& misfit,
                                         const std::function<void()>& on_frame = {});

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_STEP_ERRORS_H_
