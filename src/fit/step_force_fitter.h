// Estimates the external forces of one time step from the observed motion of the surface (Transue &
// Choi 2015, section 7).
//
// There are two formulations. Eliminating the positions leaves a small dense problem but costs one
// back-substitution per unknown and iteration (coefficient_fit.h). With the positions as unknowns
// the Jacobian is sparse, and an iteration costs about six factorisations of the matrix of the
// step, independently of the number of forces (position_fit.h). The first is cheaper for up to
// about a dozen coefficients (tests/benchmark/README.md) and is chosen for these. It is also chosen
// for up to 150 forces on single nodes, whose places then are the unknowns: it follows large
// deformations of nonlinear materials, in which the second ends far from the balance.
#ifndef LACUNA_FIT_STEP_FORCE_FITTER_H_
#define LACUNA_FIT_STEP_FORCE_FITTER_H_

#include <Eigen/Core>
#include <memory>

#include "fem/model.h"
#include "fem/step_equation.h"
#include "fit/force_fit.h"
#include "fit/force_model.h"
#include "fit/observations.h"

namespace lacuna {

// Fits the forces of one step repeatedly, as the observations are refined. Each fit starts from the
// result of the previous one and reuses its derivatives and factors.
class StepForceFitter {
 public:
  // `position` (3n, m) is the start of the search, with gripped nodes where their grip puts them; a
  // closer start saves iterations. `coefficients` (K) likewise; empty: 0. The model, the equation
  // and the force model must outlive the fitter.
  StepForceFitter(const Model& model, const StepEquation& equation, const ForceModel& force_model,
                  const Eigen::VectorXd& position, const Eigen::VectorXd& coefficients = {});
  ~StepForceFitter();

  // A fit that cannot be performed or does not converge says why in its status and message. Throws
  // Interrupted after an interrupt.
  ForceFit Fit(const Observations& observations, const ForceFitPrior& prior = {},
               const ForceFitOptions& options = {});

  // The covariance of the coefficients (K × K) at the solution of a fit (force_response.h). Empty
  // if it cannot be computed or if the force model has free nodes, whose forces have no
  // coefficients.
  Eigen::MatrixXd Covariance(const ForceFit& fit, const Observations& observations,
                             const ForceFitOptions& options = {}) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lacuna

#endif  // LACUNA_FIT_STEP_FORCE_FITTER_H_
