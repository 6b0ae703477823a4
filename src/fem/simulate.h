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
  int max_iterations = 50;  // of Newton's method; more: slower to give up
  // ‖r‖ over the free nodes, relative to the forces at work (the sum of the norms of inertia, each
  // effect and the external force); smaller: more iterations, one or two where they are quadratic.
  double relative_tolerance = 1e-8;
  LinearSolverOptions linear = {};
  // A step that ends with an inverted element is not usable. Switch off for linear elasticity,
  // whose small-strain law does not know inversion.
  bool refuse_inverted = true;
};

struct StepSummary {
  enum class Status { kNotRun, kConverged, kNoConvergence, kInvertedElement, kLinearSolverFailed };
  Status status = Status::kNotRun;
  std::string message;  // names step, node or element
  int iterations = 0;
  int factorisations = 0;
  int load_increments = 0;  // 0: reached at once
  double residual = 0;      // ‖r‖∞ over the free nodes, N
  bool IsUsable() const { return status == Status::kConverged; }
};

// Takes steps of one model. Keeps what can be kept between them: pattern, symbolic analysis,
// factor.
//
// Newton's method with the exact tangent, or its definite stand-in where that one is indefinite,
// and a line search on the potential of r where there is one, else on the work of r along the step
// (the same thing to second order). A step or equilibrium that is not reached at once is approached
// by increments of load and grip motion together. A solution with an inverted element is no
// success.
class Stepper {
 public:
  // Nodes in two grips are refused (InputError), as are node numbers that the mesh does not have.
  Stepper(const Model& model, const StepOptions& options);
  ~Stepper();
  Stepper(Stepper&&) noexcept;
  Stepper& operator=(Stepper&&) noexcept;

  // Advances `history` by one step of `time_step` under the effects and an additional nodal force
  // (3n, N; empty: none). On failure `history` is left as it was.
  StepSummary Step(double time_step, const Eigen::VectorXd& external_force, MotionHistory* history);

  // The static equilibrium under the effects and the grips at `history->time`, from the positions
  // in `history`. On success velocities are 0 and there is no previous step. `tighter`: the
  // tolerance, in parts of that of a step.
  StepSummary Equilibrium(const Eigen::VectorXd& external_force, MotionHistory* history,
                          double tighter = 1);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_SIMULATE_H_
