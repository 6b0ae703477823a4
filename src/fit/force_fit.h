// The forces of one time step, found from where the surface went (Transue & Choi 2015, section 7).
//
// Ceres minimises the displacement residual of Eq. 1 over the forces that a force model allows,
// subject to the equation of motion of the step (fem/step_equation.h). Two formulations, by what
// grows: with few coefficients the positions are eliminated, which leaves a small dense problem
// (fit/coefficient_fit.h); with unknown forces at many nodes the positions are the unknowns, which
// keeps the Jacobian sparse (fit/position_fit.h).
#ifndef LACUNA_FIT_FORCE_FIT_H_
#define LACUNA_FIT_FORCE_FIT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fem/model.h"
#include "fem/step_equation.h"
#include "fit/force_model.h"
#include "fit/observations.h"

namespace lacuna {

struct ForceFitOptions {
  // With free nodes only: a nodal force out of balance is measured by the length that it would move
  // its node alone (force over the node's own stiffness). Imbalances of this length cost as much as
  // a residual of one standard deviation, m; larger: easier steps, more fits until the multiplier
  // has settled.
  double balance_tolerance = 1e-5;
  // Expected size of a free node's force (less the previous step's), as such a length, m; larger:
  // follows the data more closely, noise included.
  double free_force_scale = 1e-3;
  // Residuals beyond this many standard deviations count linearly (Huber); 0: all squared.
  double robust_threshold = 3;
  int max_iterations = 25;           // of Levenberg–Marquardt, each one sparse factorisation
  double function_tolerance = 1e-6;  // relative decrease that ends the iteration
};

struct ForceFit {
  enum class Status { kNotRun, kConverged, kNoConvergence, kNoUnknowns, kNothingObserved };
  Status status = Status::kNotRun;
  std::string message;
  Eigen::VectorXd position;      // 3n, m: the fitted end of the step
  Eigen::VectorXd force;         // 3n, N: the fitted outer forces; 0 where the model has none
  Eigen::VectorXd coefficients;  // K
  Eigen::VectorXd multiplier;    // 3n, N: of the balance constraint, see ForceFitStart
  int factorisations = 0;
  double initial_cost = 0, final_cost = 0;
  double weighted_rms = 0;  // of the observations, in their standard deviations
  double imbalance = 0;     // rms of the forces the model does not allow, as a length, m
  bool IsUsable() const { return status == Status::kConverged; }
};

// Where the search begins. The nearer, the fewer iterations.
struct ForceFitStart {
  Eigen::VectorXd position;      // 3n, m; gripped nodes where their grip puts them
  Eigen::VectorXd coefficients;  // K; empty: 0
  Eigen::VectorXd multiplier;    // 3n, N: that of an earlier fit of the same step; empty: 0
};
// What the forces are expected to be, for example those of the step before.
struct ForceFitPrior {
  Eigen::VectorXd force;         // 3n, N, read at free nodes; empty: 0
  Eigen::VectorXd coefficients;  // K; empty: 0
};

ForceFit FitStepForces(const Model& model, const StepEquation& equation,
                       const ForceModel& force_model, const Observations& observations,
                       const ForceFitStart& start, const ForceFitPrior& prior,
                       const ForceFitOptions& options = {});

// n: the nodes that a grip holds.
std::vector<char> GrippedNodes(const Model& model);

double RootMeanSquare(const std::vector<double>& values);

}  // namespace lacuna

#endif  // LACUNA_FIT_FORCE_FIT_H_
