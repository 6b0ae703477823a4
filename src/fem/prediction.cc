#include "fem/prediction.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/interrupt.h"
#include "core/memory_limit.h"
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

// The end of a step.
struct EndState {
  Knot<Eigen::VectorXd> state;
  Knot<Eigen::MatrixXd> jacobian;
  Eigen::VectorXd reaction;
  Eigen::MatrixXd reaction_jacobian;
};

EndState EndOf(const MotionHistory& history, const TangentLinear& linear) {
  return {{history.position, history.velocity}, {linear.position(), linear.velocity()}, {}, {}};
}

// The reactions at the end of the step of `equation`.
void AddReactions(const Model& model, const std::vector<Reaction>& reactions,
                  const StepEquation& equation, const Eigen::VectorXd& external_force,
                  const TangentLinear& linear, EndState* end) {
  if (reactions.empty()) return;
  const Eigen::VectorXd& position = end->state.position;
  const Eigen::VectorXd forces = NodalReactions(equation, position, external_force);
  end->reaction = SumReactions(model, reactions, position, forces);
  end->reaction_jacobian =
      SumReactionChanges(model, reactions, position, forces, linear.position(), linear.reaction());
}

// The requested times, which are visited in their order.
class Visits {
 public:
  using Visit = std::function<void(int index, const PredictedState& state)>;
  // The references must outlive this.
  Visits(const std::vector<double>& times, const Visit& visit, PredictionSummary* summary)
      : times_(times), visit_(visit), summary_(*summary) {}

  bool AreLeft() const { return next_ < times_.size(); }
  double NextTime() const { return times_[next_]; }

  // Visits the times up to `end`, the end of a step of that length between the two states; of
  // length 0 where they are the same.
  void Until(double end, double length, const EndState& from, const EndState& to) {
    const Eigen::VectorXd rate = length > 0
                                     ? Eigen::VectorXd((to.reaction - from.reaction) / length)
                                     : Eigen::VectorXd::Zero(to.reaction.size());
    while (AreLeft() && NextTime() <= end) {
      const double t = length > 0 ? 1 - (end - NextTime()) / length : 1;
      const auto state = length > 0 ? Interpolate(from.state, to.state, length, t) : to.state;
      const Eigen::MatrixXd jacobian =
          length > 0 ? InterpolatePosition(from.jacobian, to.jacobian, length, t)
                     : to.jacobian.position;
      const Eigen::VectorXd reaction = (1 - t) * from.reaction + t * to.reaction;
      const Eigen::MatrixXd reaction_jacobian =
          (1 - t) * from.reaction_jacobian + t * to.reaction_jacobian;
      visit_(static_cast<int>(next_), {NextTime(), state.position, state.velocity, jacobian,
                                       reaction, rate, reaction_jacobian});
      summary_.states = static_cast<int>(++next_);
    }
  }

 private:
  const std::vector<double>& times_;
  const Visit& visit_;
  PredictionSummary& summary_;
  size_t next_ = 0;
};

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
  TangentLinear linear(
      model, perturbations,
      {.with_reactions = !options.reactions.empty(), .tolerance = options.sensitivity_tolerance});
  MotionHistory history = RestHistory(model);
  history.time = options.start_time;

  MotionHistory before = history;
  const StepSummary equilibrium = Hold(options, &stepper, &history);
  if (equilibrium.status == StepSummary::Status::kMissingMass)
    return Stopped(summary, equilibrium.message);
  if (!equilibrium.IsUsable())
    return Stopped(summary, (model.grips.empty()
                                 ? "no equilibrium to start from, and no grip holds the object: "
                                 : "no equilibrium to start from: ") +
                                equilibrium.message);
  summary.held = history.position;
  TangentLinearSummary linearised =
      linear.Advance(before, TimeScheme::kQuasiStatic, 0, history.position);
  if (!linearised.IsUsable()) return Stopped(summary, linearised.message);

  Visits visits(times, visit, &summary);
  EndState from = EndOf(history, linear);
  AddReactions(model, options.reactions, StepEquation(model, before, TimeScheme::kQuasiStatic, 0),
               options.held_force, linear, &from);
  visits.Until(options.start_time, 0, from, from);
  while (visits.AreLeft()) {
    ThrowIfInterrupted();
    ThrowIfOverMemoryLimit();
    before = history;
    const auto [length, end] = NextStep(options.step.scheme, options.time_step, summary.steps,
                                        history.time, visits.NextTime());
    const StepSummary step = stepper.Step(length, {}, &history);
    if (!step.IsUsable()) return Stopped(summary, step.message);
    linearised = linear.Advance(before, options.step.scheme, length, history.position);
    if (!linearised.IsUsable()) return Stopped(summary, linearised.message);
    history.time = end;
    ++summary.steps;
    EndState to = EndOf(history, linear);
    AddReactions(model, options.reactions, StepEquation(model, before, options.step.scheme, length),
                 {}, linear, &to);
    visits.Until(history.time, length, from, to);
    from = std::move(to);
  }
  summary.status = PredictionSummary::Status::kReached;
  return summary;
}

}  // namespace lacuna
