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

// The tolerance of the first equilibrium relative to that of a step. It is tighter, so that the
// start of the search has no influence.
constexpr double kHoldTolerance = 0.01;

// Brings `history` into the equilibrium in which the body is held before it is released.
StepSummary Hold(const PredictionOptions& options, Stepper* stepper, MotionHistory* history) {
  if (options.held_guess.size() > 0) {
    MotionHistory near = *history;
    near.position = options.held_guess;
    StepSummary held = stepper->Equilibrium(options.held_force, &near, kHoldTolerance);
    if (held.IsUsable()) {
      *history = near;
      return held;
    }
  }
  return stepper->Equilibrium(options.held_force, history, kHoldTolerance);
}

// The end of a step, as in PredictedState.
struct EndState {
  Knot<Eigen::VectorXd> state;
  Knot<Eigen::MatrixXd> jacobian;
  Eigen::VectorXd reaction;
  Eigen::MatrixXd reaction_jacobian;
};

EndState EndOf(const MotionHistory& history, const TangentLinear& linear) {
  return {{history.position, history.velocity}, {linear.position(), linear.velocity()}, {}, {}};
}

// Sets the reactions at the end of the step of `equation`.
void SetReactions(const Model& model, const std::vector<Reaction>& reactions,
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

// One prediction. The references must outlive it.
class PredictionRun {
 public:
  PredictionRun(const Model& model, const PredictionOptions& options,
                const std::vector<double>& times, const std::vector<Perturbation>& perturbations,
                const Visits::Visit& visit)
      : model_(model),
        options_(options),
        stepper_(model, options.step),
        linear_(model, perturbations,
                {.with_reactions = !options.reactions.empty(),
                 .tolerance = options.sensitivity_tolerance}),
        history_(RestHistory(model)),
        visits_(times, visit, &summary_) {
    history_.time = options.start_time;
  }

  PredictionSummary Run() {
    if (!Start()) return summary_;
    while (visits_.AreLeft()) {
      ThrowIfInterrupted();
      ThrowIfOverMemoryLimit();
      if (!TakeStep()) return summary_;
    }
    summary_.status = PredictionSummary::Status::kReached;
    return summary_;
  }

 private:
  // Finds the equilibrium at the start and visits the times up to it. Returns false, with status
  // and message, if the prediction ends here; so does TakeStep().
  bool Start() {
    before_ = history_;
    const StepSummary equilibrium = Hold(options_, &stepper_, &history_);
    if (equilibrium.status == StepSummary::Status::kMissingMass) return Stop(equilibrium.message);
    if (!equilibrium.IsUsable())
      return Stop((model_.grips.empty()
                       ? "no equilibrium to start from, and no grip holds the object: "
                       : "no equilibrium to start from: ") +
                  equilibrium.message);
    summary_.held = history_.position;
    if (!AdvanceSensitivities(TimeScheme::kQuasiStatic, 0)) return false;
    latest_ = EndOf(history_, linear_);
    SetReactions(model_, options_.reactions,
                 StepEquation(model_, before_, TimeScheme::kQuasiStatic, 0), options_.held_force,
                 linear_, &latest_);
    visits_.Until(options_.start_time, 0, latest_, latest_);
    return true;
  }

  // Takes one step and visits the times within it.
  bool TakeStep() {
    const TimeScheme scheme = options_.step.scheme;
    before_ = history_;
    const auto [length, end] =
        NextStep(scheme, options_.time_step, summary_.steps, history_.time, visits_.NextTime());
    const StepSummary step = stepper_.Step(length, {}, &history_);
    if (!step.IsUsable()) return Stop(step.message);
    if (!AdvanceSensitivities(scheme, length)) return false;
    history_.time = end;
    ++summary_.steps;
    EndState to = EndOf(history_, linear_);
    SetReactions(model_, options_.reactions, StepEquation(model_, before_, scheme, length), {},
                 linear_, &to);
    visits_.Until(history_.time, length, latest_, to);
    latest_ = std::move(to);
    return true;
  }

  // Advances the sensitivities over the latest step, which leads to the present position.
  bool AdvanceSensitivities(TimeScheme scheme, double length) {
    const TangentLinearSummary linearised =
        linear_.Advance(before_, scheme, length, history_.position);
    return linearised.IsUsable() || Stop(linearised.message);
  }

  // Always returns false.
  bool Stop(const std::string& why) {
    summary_.status = PredictionSummary::Status::kStopped;
    summary_.message = why;
    return false;
  }

  const Model& model_;
  const PredictionOptions& options_;
  Stepper stepper_;
  TangentLinear linear_;
  MotionHistory history_;  // of the motion so far
  // At the start of the latest step. A member, so that its vectors are allocated only once.
  MotionHistory before_;
  PredictionSummary summary_;
  Visits visits_;
  EndState latest_;  // the end of the latest step
};

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
  return PredictionRun(model, options, times, perturbations, visit).Run();
}

}  // namespace lacuna
