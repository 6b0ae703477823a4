// How the end of a step answers to the forces of a model, to first order.
#ifndef LACUNA_FIT_FORCE_RESPONSE_H_
#define LACUNA_FIT_FORCE_RESPONSE_H_

#include <Eigen/Core>

#include "fem/model.h"
#include "fem/step_equation.h"
#include "fit/force_model.h"
#include "fit/observations.h"

namespace lacuna {

struct ForceResponse {
  enum class Status { kNotRun, kSolved, kLinearSolverFailed };
  Status status = Status::kNotRun;
  Eigen::MatrixXd sensitivity;  // 3n × K, m: ∂x/∂c = (∂r/∂x)⁻¹ B, by the implicit function theorem
  int factorisations = 0;
  bool IsUsable() const { return status == Status::kSolved; }
};

// At `position` (3n, m), where the step is in balance. One factor serves all K columns.
ForceResponse RespondToForces(const Model& model, const StepEquation& equation,
                              const ForceModel& force_model, const Eigen::VectorXd& position);

// (JᵀJ + I)⁻¹ with J the whitened observations' derivative by the coefficients (K × K): what the
// observations and the standard normal prior leave open of them, if the observations' standard
// deviations are right and the problem is linear on that scale. Observations beyond
// `robust_threshold` deviations count as Huber's loss weighs them (0: all count in full).
Eigen::MatrixXd CoefficientCovariance(const ForceResponse& response,
                                      const Observations& observations,
                                      const Eigen::VectorXd& position, double robust_threshold);

}  // namespace lacuna

#endif  // LACUNA_FIT_FORCE_RESPONSE_H_
