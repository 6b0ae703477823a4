// Predicts a motion: everything is simulated from its start, nothing follows a measurement.
#ifndef LACUNA_FEM_PREDICTION_H_
#define LACUNA_FEM_PREDICTION_H_

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "fem/simulate.h"
#include "fem/tangent_linear.h"

namespace lacuna {

// A prediction's next step after `steps_before`, from `time`, s; `wanted`: the next of the times
// asked for, after it. The first step, of implicit Euler, is a tenth of the others: letting go is a
// shock, and what that step gets wrong of it goes with the square of its length. Quasi-static steps
// are as even as they can be and end at the times asked for: between two equilibria nothing tells a
// velocity.
struct PredictionStep {
  double length = 0, end = 0;  // s
};
PredictionStep NextStep(TimeScheme scheme, double time_step, int steps_before, double time,
                        double wanted);

struct PredictionOptions {
  // The body is in equilibrium until then, under its effects, its grips where they are then, and
  // `held_force`; from then on it moves without `held_force`.
  double start_time = 0;            // s
  Eigen::VectorXd held_force = {};  // 3n, N; empty: none
  // 3n, m: where the equilibrium is sought, near it a tenth of the work; empty, or where it is not
  // found from there: from the rest shape.
  Eigen::VectorXd held_guess = {};
  double time_step = 0.005;  // s, at most; smaller: slower, more accurate (OrderOf)
  StepOptions step = {.scheme = TimeScheme::kTwoStep};
};

// The motion at one of the times asked for. Sensitivities are 3n × perturbations, empty without
// any. Refers to vectors that live during the visit only.
struct PredictedState {
  double time = 0;  // s
  const Eigen::VectorXd& position;
  const Eigen::VectorXd& velocity;
  const Eigen::MatrixXd& position_by;
  const Eigen::MatrixXd& velocity_by;
};

struct PredictionSummary {
  enum class Status { kNotRun, kReached, kStopped };
  Status status = Status::kNotRun;
  std::string message;  // why it stopped, and when
  int steps = 0;
  int states = 0;        // visited, of those asked for
  Eigen::VectorXd held;  // 3n, m: the equilibrium
  bool IsUsable() const { return status == Status::kReached; }
};

// Visits the motion at `times` (s, ascending), between the ends of steps by cubic Hermite
// interpolation, whose error is of higher order than the step's. A step that fails ends the
// prediction; the states visited before are good. Quasi-static: the body is in equilibrium
// throughout, and its velocity is the step's mean. Throws Interrupted.
PredictionSummary Predict(const Model& model, const PredictionOptions& options,
                          const std::vector<double>& times,
                          const std::vector<Perturbation>& perturbations,
                          const std::function<void(int index, const PredictedState& state)>& visit);

}  // namespace lacuna

#endif  // LACUNA_FEM_PREDICTION_H_
