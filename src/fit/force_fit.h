// The forces of one time step, found from where the surface went (Transue & Choi 2015, section 7).
//
// Ceres minimises the displacement residual of Eq. 1 over the forces that a force model allows,
// subject to the equation of motion of the step (fem/step_equation.h). Two formulations, by what
// grows: eliminating the positions leaves a small dense problem but takes a back-substitution for
// each coefficient in each iteration (fit/coefficient_fit.h); with the positions as unknowns the
// Jacobian is sparse, and an iteration costs about six factorisations of the step's own matrix
// however many forces there are (fit/position_fit.h). The first is the cheaper one up to some
// dozen coefficients (tests/benchmark/README.md).
#ifndef LACUNA_FIT_FORCE_FIT_H_
#define LACUNA_FIT_FORCE_FIT_H_

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "fem/model.h"
#include "fem/step_equation.h"
#include "fit/force_model.h"
#include "fit/observations.h"

namespace lacuna {

struct ForceFitOptions {
  // With the positions as unknowns: a nodal force out of balance is measured by the length that it
  // would move its node alone (force over the node's own stiffness). Imbalances of this length cost
  // as much as a residual of one standard deviation, m. Smaller: better balanced, harder
  // numerically (below 1e-7 of the object's size iterations multiply); larger: more fits until the
  // multiplier has settled, above 1e-4 of the size it may not.
  double balance_tolerance = 1e-6;
  // Expected size of a free node's force (less the previous step's), as such a length, m; larger:
  // follows the data more closely, noise included.
  double free_force_scale = 1e-3;
  // Residuals beyond this many standard deviations count linearly (Huber); 0: all squared.
  double robust_threshold = 3;
  int max_iterations = 100;          // of Levenberg–Marquardt, each one sparse factorisation
  double function_tolerance = 1e-6;  // relative decrease that ends the iteration
};

struct ForceFit {
  enum class Status { kNotRun, kConverged, kNoConvergence, kNoUnknowns, kNothingObserved };
  Status status = Status::kNotRun;
  std::string message;
  Eigen::VectorXd position;      // 3n, m: the fitted end of the step
  Eigen::VectorXd force;         // 3n, N: the fitted outer forces; 0 where the model has none
  Eigen::VectorXd coefficients;  // K
  Eigen::VectorXd multiplier;  // 3n, N: of the balance constraint, where the positions are unknowns
  int factorisations = 0;
  double initial_cost = 0, final_cost = 0;
  double weighted_rms = 0;  // of the observations, in their standard deviations
  double imbalance = 0;     // rms of the forces the model does not allow, as a length, m
  bool IsUsable() const { return status == Status::kConverged; }
};

// What the forces are expected to be, for example those of the step before.
struct ForceFitPrior {
  Eigen::VectorXd force;         // 3n, N, read at free nodes; empty: 0
  Eigen::VectorXd coefficients;  // K; empty: 0
};

// Fits the forces of one step, again and again as the observations are improved. Keeps what can be
// kept between the fits: each begins where the last one ended, with its derivatives and factors.
class StepForceFitter {
 public:
  // `position` (3n, m): where the search begins, gripped nodes where their grip puts them; the
  // nearer, the fewer iterations. `coefficients` (K): likewise; empty: 0. The model, the equation
  // and the force model must outlive the fitter.
  StepForceFitter(const Model& model, const StepEquation& equation, const ForceModel& force_model,
                  const Eigen::VectorXd& position, const Eigen::VectorXd& coefficients = {});
  ~StepForceFitter();

  ForceFit Fit(const Observations& observations, const ForceFitPrior& prior = {},
               const ForceFitOptions& options = {});

  // Covariance of the coefficients (K × K) where a fit ended (fit/force_response.h); empty where
  // they cannot be had, or the force model has free nodes: those have no coefficients.
  Eigen::MatrixXd Covariance(const ForceFit& fit, const Observations& observations,
                             const ForceFitOptions& options = {}) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

double RootMeanSquare(const std::vector<double>& values);

}  // namespace lacuna

#endif  // LACUNA_FIT_FORCE_FIT_H_
