#include "fit/coefficient_fit.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>
#include <glog/logging.h>

#include <cmath>
#include <vector>

#include "fem/linear_solver.h"
#include "fem/newton.h"
#include "fit/force_response.h"

namespace lacuna {
namespace {

constexpr double kBalanceTolerance = 1e-10;  // Newton residual relative to the acting forces
constexpr double kSolverTolerance = 1e-7;    // residual of the linear system of a Newton step
constexpr int kNewtonIterations = 30;
constexpr int kMaxLoadParts = 8;

LinearSolverOptions WithTolerance(double tolerance) {
  LinearSolverOptions options;
  options.relative_tolerance = tolerance;
  return options;
}

// Computes x(c) and ∂x/∂c at the coefficients that Ceres is about to evaluate.
class BalancedMotion : public ceres::EvaluationCallback {
 public:
  BalancedMotion(const Model& model, const StepEquation& equation, const ForceModel& force_model,
                 const Eigen::VectorXd& position, const Eigen::VectorXd* coefficients)
      : model_(model),
        force_model_(force_model),
        equation_(equation),
        coefficients_(coefficients),
        held_(HeldAxes(model)),
        gripped_place_(position),
        newton_solver_(model.body->pattern, held_, WithTolerance(kSolverTolerance)),
        tangent_(model.body->pattern),
        differentiated_position_(position),
        position_(position) {}

  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override {
    if (IsDifferentiatedHere()) {
      position_ = differentiated_position_;
      is_balanced_ = true;
      return;
    }
    if (new_evaluation_point) is_balanced_ = Balance();
    if (evaluate_jacobians && is_balanced_) is_balanced_ = Differentiate();
  }

  bool is_balanced() const { return is_balanced_; }
  const Eigen::VectorXd& position() const { return position_; }
  const Eigen::MatrixXd& sensitivity() const { return sensitivity_; }
  int factorisations() const { return newton_solver_.factorisations() + response_factorisations_; }

 private:
  bool IsDifferentiatedHere() const {
    return sensitivity_.size() > 0 && *coefficients_ == differentiated_coefficients_;
  }

  // Solves for the balance, starting with a step along the tangent from the latest differentiated
  // point. If this fails, the change of the coefficients is applied in increasingly many parts.
  bool Balance() {
    for (int parts = 1; parts <= kMaxLoadParts; parts *= 2) {
      position_ = differentiated_position_;
      if (sensitivity_.size() > 0 && parts == 1)
        position_ += sensitivity_ * (*coefficients_ - differentiated_coefficients_);
      const Eigen::VectorXd from = differentiated_coefficients_.size() > 0
                                       ? differentiated_coefficients_
                                       : Eigen::VectorXd::Zero(coefficients_->size());
      bool solved = true;
      for (int part = 1; part <= parts && solved; ++part) {
        const double share = static_cast<double>(part) / parts;
        const Eigen::VectorXd force = force_model_.basis * (from + share * (*coefficients_ - from));
        const NewtonProblem problem{equation_, force, held_, kBalanceTolerance, kNewtonIterations};
        solved = SolveByNewton(problem, gripped_place_, &newton_solver_, &tangent_, &position_)
                     .IsUsable();
      }
      if (solved) return true;
    }
    return false;
  }

  bool Differentiate() {
    ForceResponse response = RespondToForces(model_, equation_, force_model_, position_);
    response_factorisations_ += response.factorisations;
    if (!response.IsUsable()) return false;
    sensitivity_ = std::move(response.sensitivity);
    differentiated_position_ = position_;
    differentiated_coefficients_ = *coefficients_;
    return true;
  }

  const Model& model_;
  const ForceModel& force_model_;
  const StepEquation& equation_;
  const Eigen::VectorXd* coefficients_;
  HeldComponents held_;
  Eigen::VectorXd gripped_place_;
  LinearSolver newton_solver_;
  int response_factorisations_ = 0;
  BlockMatrix tangent_;
  Eigen::VectorXd differentiated_position_, differentiated_coefficients_;  // the point of ∂x/∂c
  Eigen::VectorXd position_;
  Eigen::MatrixXd sensitivity_;  // 3n × K
  bool is_balanced_ = false;
};

// The whitened residual W (N x(c) − y) as a function of the coefficients.
class ReducedObservationCost : public ceres::CostFunction {
 public:
  ReducedObservationCost(const BalancedMotion& motion, const Observations& observations,
                         Eigen::Index j, Eigen::Index coefficients)
      : motion_(motion),
        node_(observations.node.col(j)),
        weight_(observations.weight.col(j)),
        target_(observations.target.col(j)),
        rows_(WhitenedDirections(observations, j)) {
    set_num_residuals(static_cast<int>(rows_.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(coefficients));
  }

  bool Evaluate(double const* const* /*parameters*/, double* residuals,
                double** jacobians) const override {
    if (!motion_.is_balanced()) return false;
    Eigen::Vector3d deviation = -target_;
    for (int a = 0; a < 3; ++a)
      deviation += weight_[a] * motion_.position().segment<3>(3 * node_[a]);
    Eigen::Map<Eigen::VectorXd>(residuals, rows_.rows()) = rows_ * deviation;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    const Eigen::Index coefficients = motion_.sensitivity().cols();
    Eigen::MatrixXd derivative = Eigen::MatrixXd::Zero(3, coefficients);
    for (int a = 0; a < 3; ++a) {
      if (weight_[a] != 0)
        derivative += weight_[a] * motion_.sensitivity().middleRows(3 * node_[a], 3);
    }
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        jacobians[0], rows_.rows(), coefficients) = rows_ * derivative;
    return true;
  }

 private:
  const BalancedMotion& motion_;
  Eigen::Vector3i node_;
  Eigen::Vector3d weight_, target_;
  Eigen::Matrix<double, Eigen::Dynamic, 3> rows_;
};

double RootMeanSquare(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
}

}  // namespace

struct CoefficientFitter::Implementation {
  Implementation(const Model& model, const StepEquation& equation, const ForceModel& force_model,
                 const Eigen::VectorXd& position, const Eigen::VectorXd& start)
      : coefficients(start),
        basis(force_model.basis),
        motion(model, equation, force_model, position, &coefficients) {}

  Eigen::VectorXd coefficients;
  const Eigen::SparseMatrix<double, Eigen::RowMajor>& basis;
  BalancedMotion motion;
};

CoefficientFitter::CoefficientFitter(const Model& model, const StepEquation& equation,
                                     const ForceModel& force_model, const Eigen::VectorXd& position,
                                     const Eigen::VectorXd& coefficients)
    : implementation_(
          std::make_unique<Implementation>(model, equation, force_model, position, coefficients)) {
  for (const char free : force_model.free) CHECK(!free);
}

CoefficientFitter::~CoefficientFitter() = default;

ForceFit CoefficientFitter::Fit(const Observations& observations, const ForceFitPrior& prior,
                                const ForceFitOptions& options) {
  BalancedMotion& motion = implementation_->motion;
  Eigen::VectorXd& coefficients = implementation_->coefficients;
  const Eigen::Index count = coefficients.size();
  const int factorisations_before = motion.factorisations();
  ForceFit fit;
  fit.multiplier = Eigen::VectorXd::Zero(motion.position().size());

  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &motion;
  ceres::Problem problem(problem_options);
  std::vector<ceres::ResidualBlockId> observed;
  for (Eigen::Index j = 0; j < observations.Count(); ++j) {
    ceres::LossFunction* loss =
        options.robust_threshold > 0 ? new ceres::HuberLoss(options.robust_threshold) : nullptr;
    observed.push_back(problem.AddResidualBlock(
        new ReducedObservationCost(motion, observations, j, count), loss, coefficients.data()));
  }
  problem.AddResidualBlock(
      new ceres::NormalPrior(Eigen::MatrixXd::Identity(count, count), prior.coefficients), nullptr,
      coefficients.data());

  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.num_threads = 1;  // Ceres sums over threads in no fixed order
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);

  fit.factorisations = motion.factorisations() - factorisations_before;
  fit.initial_cost = summary.initial_cost;
  fit.final_cost = summary.final_cost;
  fit.message = summary.message;
  fit.status = ForceFit::Status::kNoConvergence;
  if (!summary.IsSolutionUsable()) return fit;

  ceres::Problem::EvaluateOptions observed_only;
  observed_only.residual_blocks = observed;
  observed_only.apply_loss_function = false;
  std::vector<double> residuals;
  // This evaluation also returns the motion to the best coefficients, which need not be the last
  // ones that were tried.
  if (!problem.Evaluate(observed_only, nullptr, &residuals, nullptr, nullptr)) return fit;
  fit.weighted_rms = RootMeanSquare(residuals);
  fit.position = motion.position();
  fit.coefficients = coefficients;
  fit.force = implementation_->basis * coefficients;
  if (summary.termination_type == ceres::CONVERGENCE) fit.status = ForceFit::Status::kConverged;
  return fit;
}

}  // namespace lacuna
