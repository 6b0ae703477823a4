// Newton's method for one step, and a trajectory of steps.
#ifndef LACUNA_FEM_SIMULATE_H_
#define LACUNA_FEM_SIMULATE_H_

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "fem/linear_solver.h"
#include "fem/model.h"
#include "fem/step_equation.h"

namespace lacuna {

struct StepOptions {
  TimeScheme scheme = TimeScheme::kBdf2;
  int max_iterations = 50;            // of Newton's method
  double relative_tolerance = 1e-8;   // ‖r‖ over the free nodes, relative to the forces at work
  LinearSolverOptions linear;
};

struct StepSummary {
  enum class Status { kNotRun, kConverged, kNoConvergence, kInvertedElement, kLinearSolverFailed };
  Status status = Status::kNotRun;
  std::string message;  // names step, node or element
  int iterations = 0;
  int factorisations = 0;
  double residual = 0;  // ‖r‖∞ over the free nodes, N
  bool IsUsable() const { return status == Status::kConverged; }
};

// Takes steps of one model. Keeps what can be kept between them: pattern, symbolic analysis, factor.
class Stepper {
 public:
  Stepper(const Model& model, const StepOptions& options);
  ~Stepper();

  // Advances `history` by one step of `time_step` under the effects and an additional nodal force
  // (3n, N; empty: none). On failure `history` is left as it was.
  StepSummary Step(double time_step, const Eigen::VectorXd& external_force, MotionHistory* history);

  // The static equilibrium under the effects at `history->time`, found by load increments where a
  // single solve does not converge.
  StepSummary Equilibrium(const Eigen::VectorXd& external_force, MotionHistory* history);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_SIMULATE_H_
