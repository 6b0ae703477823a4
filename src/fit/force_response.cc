#include "fit/force_response.h"

#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "fem/linear_solver.h"

namespace lacuna {
namespace {

// Only a search direction and an uncertainty depend on it.
constexpr double kTolerance = 1e-7;

// The place of observation j (3 × columns) of what is given at the nodes (3n × columns).
Eigen::MatrixXd AtPlace(const Observations& observations, Eigen::Index j,
                        const Eigen::MatrixXd& nodal) {
  Eigen::MatrixXd place = Eigen::MatrixXd::Zero(3, nodal.cols());
  for (int a = 0; a < 3; ++a) {
    const double weight = observations.weight(a, j);
    if (weight != 0) place += weight * nodal.middleRows(3 * observations.node(a, j), 3);
  }
  return place;
}

}  // namespace

ForceResponse RespondToForces(const Model& model, const StepEquation& equation,
                              const ForceModel& force_model, const Eigen::VectorXd& position) {
  const Eigen::SparseMatrix<double> loads = force_model.basis;  // column-major: a load is a column
  BlockMatrix tangent(model.body->pattern);
  equation.Tangent(position, /*convexify=*/false, &tangent);
  LinearSolverOptions options;
  options.relative_tolerance = kTolerance;
  LinearSolver solver(model.body->pattern, GrippedNodes(model), options);
  ForceResponse response;
  response.sensitivity.resize(position.size(), loads.cols());
  Eigen::VectorXd column;
  for (Eigen::Index k = 0; k < loads.cols(); ++k) {
    const bool solved = solver.Solve(tangent, loads.col(k), &column).IsUsable();
    response.factorisations = solver.factorisations();
    if (!solved) {
      response.status = ForceResponse::Status::kLinearSolverFailed;
      return response;
    }
    response.sensitivity.col(k) = column;
  }
  response.status = ForceResponse::Status::kSolved;
  return response;
}

Eigen::MatrixXd CoefficientCovariance(const ForceResponse& response,
                                      const Observations& observations,
                                      const Eigen::VectorXd& position, double robust_threshold) {
  CHECK(response.IsUsable());
  const Eigen::Index count = response.sensitivity.cols();
  Eigen::MatrixXd information = Eigen::MatrixXd::Identity(count, count);
  for (Eigen::Index j = 0; j < observations.Count(); ++j) {
    const Eigen::Vector3d deviation =
        AtPlace(observations, j, position) - observations.target.col(j);
    const Eigen::MatrixXd moved = AtPlace(observations, j, response.sensitivity);
    const auto directions = WhitenedDirections(observations, j);
    const double length = (directions * deviation).norm();
    const double trust =
        robust_threshold > 0 && length > robust_threshold ? robust_threshold / length : 1;
    const Eigen::MatrixXd jacobian = std::sqrt(trust) * (directions * moved);
    information.selfadjointView<Eigen::Lower>().rankUpdate(jacobian.transpose());
  }
  return information.selfadjointView<Eigen::Lower>().llt().solve(
      Eigen::MatrixXd::Identity(count, count));
}

Eigen::MatrixXd CoefficientAnswer(const ForceResponse& response, const Observations& observations,
                                  const Eigen::VectorXd& position, double robust_threshold,
                                  const Eigen::MatrixXd& moved) {
  CHECK(response.IsUsable());
  const Eigen::Index count = response.sensitivity.cols();
  Eigen::MatrixXd curvature = Eigen::MatrixXd::Identity(count, count);
  Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(count, moved.cols());
  for (Eigen::Index j = 0; j < observations.Count(); ++j) {
    const auto directions = WhitenedDirections(observations, j);
    const Eigen::VectorXd residual =
        directions * (AtPlace(observations, j, position) - observations.target.col(j));
    const Eigen::MatrixXd jacobian = directions * AtPlace(observations, j, response.sensitivity);
    Eigen::MatrixXd weighted = jacobian;
    const double length = residual.norm();
    if (robust_threshold > 0 && length > robust_threshold) {
      const Eigen::VectorXd along = residual / length;
      weighted -= along * (along.transpose() * jacobian);
      weighted *= robust_threshold / length;
    }
    curvature += weighted.transpose() * jacobian;
    slope += weighted.transpose() * (directions * AtPlace(observations, j, moved));
  }
  return -curvature.selfadjointView<Eigen::Lower>().llt().solve(slope);
}

}  // namespace lacuna
