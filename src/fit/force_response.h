// The first-order response of the end of a time step to the forces of a force model, and the
// covariance of their coefficients that follows from it.
#ifndef LACUNA_FIT_FORCE_RESPONSE_H_
#define LACUNA_FIT_FORCE_RESPONSE_H_

#include <Eigen/Core>

#include "fem/block_matrix.h"
#include "fem/linear_solver.h"
#include "fem/model.h"
#include "fem/step_equation.h"
#include "fit/force_model.h"
#include "fit/observations.h"

namespace lacuna {

struct ForceResponse {
  enum class Status { kNotRun, kSolved, kLinearSolverFailed };
  Status status = Status::kNotRun;
  Eigen::MatrixXd sensitivity;  // 3n × K, m: ∂x/∂c
  bool IsUsable() const { return status == Status::kSolved; }
};

// Computes ∂x/∂c = (∂r/∂x)⁻¹ B, with the basis B of the force model, by the implicit function
// theorem where the step is in balance. `tangent` is the exact ∂r/∂x there; `solver` must hold the
// components that the model holds. If it fails, the status says so and the sensitivity is
// incomplete.
ForceResponse RespondToForces(const BlockMatrix& tangent, const ForceModel& force_model,
                              LinearSolver* solver);
// RespondToForces() with the tangent of `equation` at a balanced `position` (3n, m).
ForceResponse RespondToForces(const Model& model, const StepEquation& equation,
                              const ForceModel& force_model, const Eigen::VectorXd& position);

// The posterior covariance (JᵀJ + I)⁻¹ of the coefficients (K × K), where J is the Jacobian of the
// whitened observations and I the precision of the standard normal prior. It is valid if the
// standard deviations of the observations are right and the problem is linear on that scale.
// Observations beyond `robust_threshold` standard deviations are weighted as by Huber's loss (0:
// all have full weight). CHECKs that the response is usable.
Eigen::MatrixXd CoefficientCovariance(const ForceResponse& response,
                                      const Observations& observations,
                                      const Eigen::VectorXd& position, double robust_threshold);

}  // namespace lacuna

#endif  // LACUNA_FIT_FORCE_RESPONSE_H_
