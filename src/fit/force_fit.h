// Options, prior and result of a fit of external forces to the observed end of one time step.
//
// The fit minimises the displacement residual of Transue & Choi 2015, Eq. 1, over the forces that a
// force model allows (force_model.h), subject to the equation of motion of the step
// (fem/step_equation.h). StepForceFitter (step_force_fitter.h) performs it.
#ifndef LACUNA_FIT_FORCE_FIT_H_
#define LACUNA_FIT_FORCE_FIT_H_

#include <Eigen/Core>
#include <string>

namespace lacuna {

struct ForceFitOptions {
  // Used only where the positions are unknowns, m. The force imbalance of a node is measured by the
  // length by which it would displace this node alone (imbalance divided by the node's stiffness).
  // An imbalance of this length costs as much as a residual of one standard deviation. Smaller
  // values enforce the balance more tightly but are harder numerically (below 1e-7 of the object's
  // size the number of iterations multiplies); with larger ones more fits are needed before the
  // multiplier has converged, and above 1e-4 of the size it may not converge.
  double balance_tolerance = 1e-6;
  // Expected change of a free node's force since the previous step, as a length in the same sense,
  // m. Larger values follow the data more closely, including their noise.
  double free_force_scale = 1e-3;
  // Residuals beyond this many standard deviations contribute linearly (Huber's loss); 0 disables
  // the robust loss.
  double robust_threshold = 3;
  int max_iterations = 100;          // Levenberg–Marquardt steps
  double function_tolerance = 1e-6;  // the iteration ends at this relative decrease of the cost
  // Used only where the positions are eliminated: the iteration also ends where a step lowers the
  // cost by less than this, so that the step moves no coefficient by more than √(2·0.05) ≈ 0.3 of
  // its standard deviation. Where convergence is slow, the minimum may be farther away than that.
  double immaterial_decrease = 0.05;
};

struct ForceFit {
  enum class Status {
    kNotRun,
    kConverged,
    // Only where the positions are eliminated: the forces are in balance, but the search ended
    // before the minimum of the cost; the message says why.
    kEndedEarly,
    kNoConvergence,
    kNoUnknowns,
    kNothingObserved
  };
  Status status = Status::kNotRun;
  std::string message;
  // Vectors of length 3n are node-major.
  Eigen::VectorXd position;      // 3n, m: the fitted end of the step
  Eigen::VectorXd force;         // 3n, N: the fitted external force; 0 where the model allows none
  Eigen::VectorXd coefficients;  // K, in the order of the force model's basis
  Eigen::VectorXd multiplier;    // 3n, N: for the balance constraint, if positions are unknowns
  int factorisations = 0;
  double initial_cost = 0, final_cost = 0;
  // The rms residual of the observations in standard deviations; 0 without any.
  double weighted_rms = 0;
  double imbalance = 0;  // rms of the forces that the model does not allow, as a length, m
  bool IsUsable() const { return status == Status::kConverged || status == Status::kEndedEarly; }
};

// The expected forces, for example those of the previous step.
struct ForceFitPrior {
  Eigen::VectorXd force;         // 3n, N, used at free nodes; empty: 0
  Eigen::VectorXd coefficients;  // K; empty: 0
};

}  // namespace lacuna

#endif  // LACUNA_FIT_FORCE_FIT_H_
