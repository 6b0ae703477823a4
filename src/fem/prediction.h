// The prediction of a motion: a simulation from an equilibrium, without reference to measurements.
//
// The motion and its sensitivities (tangent_linear.h) are computed step by step and interpolated at
// the requested times. Nodal vectors are 3n, node-major.
#ifndef LACUNA_FEM_PREDICTION_H_
#define LACUNA_FEM_PREDICTION_H_

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "fem/grip_reaction.h"
#include "fem/stepper.h"
#include "fem/tangent_linear.h"

namespace lacuna {

// The next step of a prediction.
struct PredictionStep {
  double length = 0, end = 0;  // s
};

// The step after `steps_before` others, from `time` (s), where `wanted` is the next requested time
// after it. The first step, of implicit Euler, is a tenth as long as the others: releasing a body
// is a shock, and the error of this step is proportional to the square of its length. Quasi-static
// steps end at the requested times and are of equal length in between, because velocities between
// two equilibria, and hence interpolation, are not defined.
PredictionStep NextStep(TimeScheme scheme, double time_step, int steps_before, double time,
                        double wanted);

struct PredictionOptions {
  // Until this time the body is in equilibrium under its effects, its grips at their positions at
  // this time, and `held_force`. After it the body moves without `held_force`.
  double start_time = 0;            // s
  Eigen::VectorXd held_force = {};  // 3n, N; empty: none
  // 3n, m: start of the search for the equilibrium; a close one saves nine tenths of the work. If
  // it is empty or the search fails, the search starts from the rest shape.
  Eigen::VectorXd held_guess = {};
  double time_step = 0.005;  // s, upper limit; a smaller one is slower and more accurate (OrderOf)
  StepOptions step = {.scheme = TimeScheme::kTwoStep};
  double sensitivity_tolerance = 1e-7;   // TangentLinearOptions::tolerance
  std::vector<Reaction> reactions = {};  // the forces and torques of grips that are wanted
};

// The motion at a requested time. The Jacobian with respect to the perturbations is 3n ×
// perturbations, in m per unit of each. All references are valid during the visit only.
struct PredictedState {
  double time = 0;  // s
  const Eigen::VectorXd& position;
  const Eigen::VectorXd& velocity;
  const Eigen::MatrixXd& position_jacobian;
  // Each of PredictionOptions::reactions (three rows each, N or N m), its rate (per s) and its
  // Jacobian (per unit).
  const Eigen::VectorXd& reaction;
  const Eigen::VectorXd& reaction_rate;
  const Eigen::MatrixXd& reaction_jacobian;
};

struct PredictionSummary {
  enum class Status { kNotRun, kReached, kStopped };
  Status status = Status::kNotRun;
  std::string message;  // why and when it stopped
  int steps = 0;
  int states = 0;        // number of requested times that were visited
  Eigen::VectorXd held;  // 3n, m: the initial equilibrium
  bool IsUsable() const { return status == Status::kReached; }
};

// Predicts the motion and calls `visit` at each of `times` (s, ascending, CHECKed) from the calling
// thread. Between the ends of steps the motion is interpolated by cubic Hermite polynomials, whose
// error is of higher order than that of the step; reactions are interpolated linearly, because
// their rates at the ends of steps are not known. A step that fails ends the prediction with
// kStopped; states that have been visited before are valid. In a quasi-static prediction the body
// is always in equilibrium, and velocities are mean values over the step. Throws Interrupted.
PredictionSummary Predict(const Model& model, const PredictionOptions& options,
                          const std::vector<double>& times,
                          const std::vector<Perturbation>& perturbations,
                          const std::function<void(int index, const PredictedState& state)>& visit);

}  // namespace lacuna

#endif  // LACUNA_FEM_PREDICTION_H_
