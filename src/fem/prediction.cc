#include "fem/prediction.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "core/interrupt.h"
#include "geometry/hermite.h"

namespace lacuna {
namespace {

PredictionSummary Stopped(PredictionSummary summary, const std::string& why) {
  summary.status = PredictionSummary::Status::kStopped;
  summary.message = why;
  return summary;
}

// Tighter than the tolerance of a step, so that the start of the search has no influence.
constexpr double kHoldTolerance = 0.01;

StepSummary Hold(const PredictionOptions& options, Stepper* stepper, MotionHistory* history) {
  if (options.held_guess.size() > 0) {
    MotionHistory near = *history;
    near.position = options.held_guess;
    const StepSummary held = stepper->Equilibrium(options.held_force, &near, kHoldTolerance);
    if (held.IsUsable()) {
      *history = near;
      return held;
    }
  }
  return stepper->Equilibrium(options.held_force, history, kHoldTolerance);
}

constexpr double kFirstStep = 0.1;  // length of the first step relative to the others
// Relative excess over the requested length that a quasi-static step may have by rounding.
constexpr double kRounding = 1e-9;

}  // namespace

PredictionStep NextStep(TimeScheme scheme, double time_step, int steps_before, double time,
                        double wanted) {
  if (scheme != TimeScheme::kQuasiStatic) {
    const double length = (steps_before == 0 ? kFirstStep : 1) * time_step;
    return {length, time + length};
  }
  const double whole = wanted - time;
  const double parts = std::ceil(whole / time_step - kRounding);
  if (parts <= 1) return {whole, wanted};
  return {whole / parts, time + whole / parts};
}

PredictionSummary Predict(
    const Model& model, const PredictionOptions& options, const std::vector<double>& times,
    const std::vector<Perturbation>& perturbations,
    const std::function<void(int index, const PredictedState& state)>& visit) {
  CHECK(std::is_sorted(times.begin(), times.end()));
  CHECK_GT(options.time_step, 0);
  PredictionSummary summary;
  Stepper stepper(model, options.step);
  TangentLinear linear(model, perturbations);
  MotionHistory history = RestHistory(model);
  history.time = options.start_time;

  MotionHistory before = history;
  const StepSummary equilibrium = Hold(options, &stepper, &history);
  if (!equilibrium.IsUsable())
    return Stopped(summary, (model.grips.empty()
                                 ? "no equilibrium to start from, and no grip holds the object: "
                                 : "no equilibrium to start from: ") +
                                equilibrium.message);
  summary.held = history.position;
  TangentLinearSummary linearised =
      linear.Advance(before, TimeScheme::kQuasiStatic, 0, history.position);
  if (!linearised.IsUsable()) return Stopped(summary, linearised.message);

  const size_t wanted = times.size();
  size_t next = 0;
  const auto visit_next = [&](const Knot<Eigen::VectorXd>& state,
                              const Knot<Eigen::MatrixXd>& jacobian) {
    visit(static_cast<int>(next),
          {times[next], state.position, state.velocity, jacobian.position, jacobian.velocity});
    ++next;
    summary.states = static_cast<int>(next);
  };
  Knot<Eigen::VectorXd> state{history.position, history.velocity};
  Knot<Eigen::MatrixXd> jacobian{linear.position(), linear.velocity()};
  while (next < wanted && times[next] <= options.start_time) visit_next(state, jacobian);

  while (next < wanted) {
    ThrowIfInterrupted();
    before = history;
    const auto [length, end] =
        NextStep(options.step.scheme, options.time_step, summary.steps, history.time, times[next]);
    const StepSummary step = stepper.Step(length, {}, &history);
    if (!step.IsUsable()) return Stopped(summary, step.message);
    linearised = linear.Advance(before, options.step.scheme, length, history.position);
    if (!linearised.IsUsable()) return Stopped(summary, linearised.message);
    history.time = end;
    ++summary.steps;
    const Knot<Eigen::VectorXd> now{history.position, history.velocity};
    const Knot<Eigen::MatrixXd> jacobian_now{linear.position(), linear.velocity()};
    while (next < wanted && times[next] <= history.time) {
      const double t = 1 - (history.time - times[next]) / length;
      visit_next(Interpolate(state, now, length, t),
                 Interpolate(jacobian, jacobian_now, length, t));
    }
    state = now;
    jacobian = jacobian_now;
  }
  summary.status = PredictionSummary::Status::kReached;
  return summary;
}

}  // namespace lacuna
