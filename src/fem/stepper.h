// Time steps and static equilibria of a model.
//
// Each step solves the equation of motion at its end (step_equation.h) by Newton's method
// (newton.h). A step or equilibrium that is not reached directly is approached in increments of the
// load together with the motion of the grips.
#ifndef LACUNA_FEM_STEPPER_H_
#define LACUNA_FEM_STEPPER_H_

#include <Eigen/Core>
#include <memory>
#include <string>

#include "fem/linear_solver.h"
#include "fem/model.h"
#include "fem/step_equation.h"

namespace lacuna {

struct StepOptions {
  TimeScheme scheme = TimeScheme::kBdf2;
  int max_iterations = 50;  // Newton iterations of a step; a larger value delays its failure
  // ‖r‖ over the free nodes relative to the acting forces, the sum of the norms of inertia, of each
  // effect and of the external force. A smaller value costs one or two more iterations.
  double relative_tolerance = 1e-8;
  LinearSolverOptions linear = {};
  // Rejects a step that ends with an inverted element. Switch off for linear elasticity, whose
  // small-strain law has no notion of inversion.
  bool refuse_inverted = true;
};

struct StepSummary {
  enum class Status {
    kNotRun,
    kConverged,
    kNoConvergence,
    kInvertedElement,
    kLinearSolverFailed,
    kMissingMass  // effects remove more mass than a part of the body has (missing_mass.h)
  };
  Status status = Status::kNotRun;
  std::string message;  // why the step failed, with time and node or element
  int iterations = 0;   // NewtonSummary::iterations
  int factorisations = 0;
  double residual = 0;  // ‖r‖∞ over the free nodes, N
  bool IsUsable() const { return status == Status::kConverged; }
};

// Takes steps of one model and keeps the pattern, the symbolic analysis and the factor between
// them. Keeps a copy of the model, which shares body and effects. Not thread-safe: one stepper per
// simulation.
class Stepper {
 public:
  // Throws InputError if a node does not exist in the mesh, or belongs to two grips that hold it
  // along the same axis. Supports at rest, each along some axes only, may share nodes.
  Stepper(const Model& model, const StepOptions& options);
  ~Stepper();
  Stepper(Stepper&&) noexcept;
  Stepper& operator=(Stepper&&) noexcept;

  // Advances `history` by one step of length `time_step` (s, > 0) under the effects and an external
  // nodal force (3n, node-major, N; empty: none). On failure the summary says why and `history` is
  // unchanged.
  StepSummary Step(double time_step, const Eigen::VectorXd& external_force, MotionHistory* history);

  // Finds the static equilibrium under the effects, the grips and the external force at
  // `history->time`, starting from the positions in `history`. On success velocities are 0 and
  // there is no previous step. `tighter` multiplies the tolerance of a step.
  StepSummary Equilibrium(const Eigen::VectorXd& external_force, MotionHistory* history,
                          double tighter = 1);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_STEPPER_H_
