#include "fit/force_response.h"

#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "fem/linear_solver.h"

namespace lacuna {
namespace {

// Moderate, because only a search direction and an uncertainty depend on it.
constexpr double kTolerance = 1e-7;

}  // namespace

ForceResponse RespondToForces(const BlockMatrix& tangent, const ForceModel& force_model,
                              LinearSolver* solver) {
  const Eigen::SparseMatrix<double> loads = force_model.basis;  // column-major: a load is a column
  ForceResponse response;
  response.sensitivity.resize(loads.rows(), loads.cols());
  Eigen::VectorXd column;
  for (Eigen::Index k = 0; k < loads.cols(); ++k) {
    if (!solver->Solve(tangent, loads.col(k), &column).IsUsable()) {
      response.status = ForceResponse::Status::kLinearSolverFailed;
      return response;
    }
    response.sensitivity.col(k) = column;
  }
  response.status = ForceResponse::Status::kSolved;
  return response;
}

ForceResponse RespondToForces(const Model& model, const StepEquation& equation,
                              const ForceModel& force_model, const Eigen::VectorXd& position) {
  LinearSolverOptions options;
  options.relative_tolerance = kTolerance;
  LinearSolver solver(model.body->pattern, HeldComponents(HeldAxes(model)), options);
  BlockMatrix tangent(model.body->pattern);
  equation.Tangent(position, /*convexify=*/false, &tangent);
  return RespondToForces(tangent, force_model, &solver);
}

Eigen::MatrixXd CoefficientCovariance(const ForceResponse& response,
                                      const Observations& observations,
                                      const Eigen::VectorXd& position, double robust_threshold) {
  CHECK(response.IsUsable());
  const Eigen::Index count = response.sensitivity.cols();
  Eigen::MatrixXd information = Eigen::MatrixXd::Identity(count, count);
  for (Eigen::Index j = 0; j < observations.Count(); ++j) {
    const Eigen::MatrixXd derivative = DeviationDerivative(observations, j, response.sensitivity);
    const auto directions = WhitenedDirections(observations, j);
    const double length = (directions * Deviation(observations, j, position)).norm();
    const double loss_weight =
        robust_threshold > 0 && length > robust_threshold ? robust_threshold / length : 1;
    const Eigen::MatrixXd jacobian = std::sqrt(loss_weight) * (directions * derivative);
    information.selfadjointView<Eigen::Lower>().rankUpdate(jacobian.transpose());
  }
  return information.selfadjointView<Eigen::Lower>().llt().solve(
      Eigen::MatrixXd::Identity(count, count));
}

}  // namespace lacuna
