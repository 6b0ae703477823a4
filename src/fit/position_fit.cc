#include "fit/position_fit.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>
#include <glog/logging.h>

#include <cmath>
#include <memory>
#include <vector>

#include "core/interrupt.h"
#include "core/serial_openmp.h"
#include "fit/stop_on_interrupt.h"

namespace lacuna {
namespace {

// Assembles r(x) and ∂r/∂x once per point that Ceres evaluates, for all residual blocks.
class AssembledStep : public ceres::EvaluationCallback {
 public:
  AssembledStep(const Model& model, const StepEquation& equation, const Eigen::VectorXd* position)
      : equation_(equation), position_(position), tangent_(model.body->pattern) {}

  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override {
    if (new_evaluation_point) {
      equation_.Residual(*position_, &residual_);
      tangent_is_current_ = false;
    }
    if (evaluate_jacobians && !tangent_is_current_) {
      equation_.Tangent(*position_, /*convexify=*/false, &tangent_);
      tangent_is_current_ = true;
    }
  }

  const Eigen::VectorXd& residual() const { return residual_; }
  const BlockMatrix& tangent() const { return tangent_; }

 private:
  const StepEquation& equation_;
  const Eigen::VectorXd* position_;
  Eigen::VectorXd residual_;
  BlockMatrix tangent_;
  bool tangent_is_current_ = false;
};

// The whitened residual W (N x − y) of one observation as a function of its nodes.
class ObservationCost : public ceres::CostFunction {
 public:
  ObservationCost(const Observations& observations, Eigen::Index j)
      : target_(observations.target.col(j)),
        weights_(observations.weight.col(j)),
        rows_(WhitenedDirections(observations, j)) {
    set_num_residuals(static_cast<int>(rows_.rows()));
    mutable_parameter_block_sizes()->assign(static_cast<size_t>(observations.NodeCount(j)), 3);
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    Eigen::Vector3d deviation = -target_;
    const int nodes = static_cast<int>(parameter_block_sizes().size());
    for (int a = 0; a < nodes; ++a)
      deviation += weights_[a] * Eigen::Map<const Eigen::Vector3d>(parameters[a]);
    Eigen::Map<Eigen::VectorXd>(residuals, rows_.rows()) = rows_ * deviation;
    if (jacobians == nullptr) return true;
    for (int a = 0; a < nodes; ++a) {
      if (jacobians[a] == nullptr) continue;
      Eigen::Map<Rows>(jacobians[a], rows_.rows(), 3) = weights_[a] * rows_;
    }
    return true;
  }

 private:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  Eigen::Vector3d target_;
  Eigen::VectorXd weights_;
  Rows rows_;
};

// The balance (r_i(x) − g_i − B_i c)/s_i of node i as a function of the positions of its neighbours
// and of the coefficients. Rows of axes along which the node is held are 0.
class BalanceCost : public ceres::CostFunction {
 public:
  using Row = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  using DenseRows = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;

  BalanceCost(const AssembledStep& step, int node, AxisSet held,
              const Eigen::Vector3d& expected_force, const DenseRows& basis, double scale)
      : step_(step),
        node_(node),
        held_(held),
        expected_(expected_force),
        basis_(basis),
        scale_(scale) {
    const BlockPattern& pattern = step.tangent().pattern();
    set_num_residuals(3);
    mutable_parameter_block_sizes()->assign(pattern.row_begin[node + 1] - pattern.row_begin[node],
                                            3);
    if (basis_.cols() > 0)
      mutable_parameter_block_sizes()->push_back(static_cast<int>(basis_.cols()));
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    Eigen::Vector3d force = step_.residual().segment<3>(3 * node_) - expected_;
    if (!force.allFinite()) return false;
    const BlockPattern& pattern = step_.tangent().pattern();
    const int neighbours = pattern.row_begin[node_ + 1] - pattern.row_begin[node_];
    if (basis_.cols() > 0) {
      force -= basis_ * Eigen::Map<const Eigen::VectorXd>(parameters[neighbours], basis_.cols());
    }
    Eigen::Map<Eigen::Vector3d> balance(residuals);
    balance = force / scale_;
    ClearHeld(&balance);
    if (jacobians == nullptr) return true;
    for (int k = 0; k < neighbours; ++k) {
      if (jacobians[k] == nullptr) continue;
      Eigen::Map<Row> jacobian(jacobians[k]);
      jacobian = step_.tangent().Block(pattern.row_begin[node_] + k) / scale_;
      ClearHeld(&jacobian);
    }
    if (basis_.cols() > 0 && jacobians[neighbours] != nullptr) {
      Eigen::Map<DenseRows> jacobian(jacobians[neighbours], 3, basis_.cols());
      jacobian = -basis_ / scale_;
      ClearHeld(&jacobian);
    }
    return true;
  }

 private:
  template <typename Rows>
  void ClearHeld(Rows* rows) const {
    for (int axis = 0; axis < 3; ++axis)
      if (held_.Has(axis)) rows->row(axis).setZero();
  }

  const AssembledStep& step_;
  int node_;
  AxisSet held_;
  Eigen::Vector3d expected_;
  DenseRows basis_;
  double scale_;
};

// The stiffness of each node against a displacement of it alone, N/m: a third of the trace of its
// diagonal block.
Eigen::VectorXd NodeStiffness(const StepEquation& equation, const Body& body,
                              const Eigen::VectorXd& position) {
  BlockMatrix tangent(body.pattern);
  equation.Tangent(position, /*convexify=*/true, &tangent);
  Eigen::VectorXd stiffness(body.NodeCount());
  for (int i = 0; i < body.NodeCount(); ++i)
    stiffness[i] = std::max(tangent.Block(body.pattern->diagonal[i]).trace() / 3, 1e-300);
  return stiffness;
}

// What the residual blocks of one fit are made from.
struct PositionFitInput {
  const Model& model;
  const ForceModel& force_model;
  const PositionFitStart& start;
  const ForceFitPrior& prior;
  const ForceFitOptions& options;
  std::vector<AxisSet> held;  // n
  Eigen::VectorXd stiffness;  // n, N/m
};

double* NodeAt(ForceFit* fit, int node) { return fit->position.data() + 3 * node; }

void AddPositions(const PositionFitInput& input, ForceFit* fit, ceres::Problem* problem) {
  for (int i = 0; i < input.model.body->NodeCount(); ++i) {
    problem->AddParameterBlock(NodeAt(fit, i), 3);
    const AxisSet held = input.held[i];
    if (held.IsAll()) {
      problem->SetParameterBlockConstant(NodeAt(fit, i));
    } else if (held.IsPartial()) {
      std::vector<int> constant;
      for (int axis = 0; axis < 3; ++axis)
        if (held.Has(axis)) constant.push_back(axis);
      problem->SetManifold(NodeAt(fit, i), new ceres::SubsetManifold(3, constant));
    }
  }
}

std::vector<ceres::ResidualBlockId> AddObservations(const Observations& observations,
                                                    const ForceFitOptions& options, ForceFit* fit,
                                                    ceres::Problem* problem) {
  std::vector<ceres::ResidualBlockId> observed;
  for (Eigen::Index j = 0; j < observations.Count(); ++j) {
    std::vector<double*> blocks;
    for (Eigen::Index a = 0; a < observations.NodeCount(j); ++a)
      blocks.push_back(NodeAt(fit, observations.node(a, j)));
    ceres::LossFunction* loss =
        options.robust_threshold > 0 ? new ceres::HuberLoss(options.robust_threshold) : nullptr;
    observed.push_back(
        problem->AddResidualBlock(new ObservationCost(observations, j), loss, blocks));
  }
  return observed;
}

void AddBalance(const PositionFitInput& input, const AssembledStep& assembled, ForceFit* fit,
                ceres::Problem* problem) {
  const BlockPattern& pattern = *input.model.body->pattern;
  const ForceModel& force_model = input.force_model;
  for (int i = 0; i < pattern.nodes; ++i) {
    if (input.held[i].IsAll()) continue;
    std::vector<double*> blocks;
    for (int k = pattern.row_begin[i]; k < pattern.row_begin[i + 1]; ++k)
      blocks.push_back(NodeAt(fit, pattern.column[k]));
    BalanceCost::DenseRows basis(3, 0);
    const bool spanned = force_model.basis.middleRows(3 * i, 3).nonZeros() > 0;
    if (spanned) {
      basis = BalanceCost::DenseRows(force_model.basis.middleRows(3 * i, 3));
      blocks.push_back(fit->coefficients.data());
    }
    Eigen::Vector3d expected = Eigen::Vector3d::Zero();
    if (force_model.free[i]) {
      expected = input.prior.force.segment<3>(3 * i);
    } else {
      expected = -input.start.multiplier.segment<3>(3 * i);
    }
    const double length =
        force_model.free[i] ? input.options.free_force_scale : input.options.balance_tolerance;
    problem->AddResidualBlock(
        new BalanceCost(assembled, i, input.held[i], expected, basis, input.stiffness[i] * length),
        nullptr, blocks);
  }
}

void AddCoefficientPrior(const PositionFitInput& input, ForceFit* fit, ceres::Problem* problem) {
  const Eigen::Index count = input.force_model.CoefficientCount();
  if (count == 0) return;
  problem->AddResidualBlock(
      new ceres::NormalPrior(Eigen::MatrixXd::Identity(count, count), input.prior.coefficients),
      nullptr, fit->coefficients.data());
}

ceres::Solver::Summary SolveInOneThread(const ForceFitOptions& options, ceres::Problem* problem) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.initial_trust_region_radius = 1e16;  // damping is relative to the stiff balance rows
  solver.num_threads = 1;  // the order in which Ceres sums over threads is not fixed
  solver.logging_type = ceres::SILENT;
  const std::unique_ptr<ceres::IterationCallback> stop = StopOnInterrupt();
  solver.callbacks.push_back(stop.get());
  ceres::Solver::Summary summary;
  const SerialOpenMp serial;
  ceres::Solve(solver, problem, &summary);
  ThrowIfInterrupted();
  return summary;
}

// Sets the fitted force, the multiplier and the imbalance from the fitted positions and
// coefficients.
void SetForces(const PositionFitInput& input, const StepEquation& equation, ForceFit* fit) {
  const int nodes = input.model.body->NodeCount();
  Eigen::VectorXd external;
  equation.Residual(fit->position, &external);
  const Eigen::VectorXd spanned_force = input.force_model.basis * fit->coefficients;
  double squared_imbalance = 0;
  for (int i = 0; i < nodes; ++i) {
    if (input.held[i].IsAll()) continue;
    const Eigen::VectorXd& source = input.force_model.free[i] ? external : spanned_force;
    fit->force.segment<3>(3 * i) = source.segment<3>(3 * i);
    Eigen::Vector3d imbalance = (external - fit->force).segment<3>(3 * i);
    for (int axis = 0; axis < 3; ++axis) {
      if (!input.held[i].Has(axis)) continue;
      fit->force[3 * i + axis] = imbalance[axis] = 0;
    }
    fit->multiplier.segment<3>(3 * i) += imbalance;
    squared_imbalance += (imbalance / input.stiffness[i]).squaredNorm() / nodes;
  }
  fit->imbalance = std::sqrt(squared_imbalance);
}

double WeightedRms(const std::vector<ceres::ResidualBlockId>& observed, ceres::Problem* problem) {
  if (observed.empty()) return 0;
  ceres::Problem::EvaluateOptions observed_only;
  observed_only.residual_blocks = observed;
  observed_only.apply_loss_function = false;
  std::vector<double> residuals;
  problem->Evaluate(observed_only, nullptr, &residuals, nullptr, nullptr);
  return Eigen::Map<const Eigen::VectorXd>(residuals.data(), residuals.size()).norm() /
         std::sqrt(static_cast<double>(residuals.size()));
}

}  // namespace

ForceFit FitPositions(const Model& model, const StepEquation& equation,
                      const ForceModel& force_model, const Observations& observations,
                      const PositionFitStart& start, const ForceFitPrior& prior,
                      const ForceFitOptions& options) {
  ForceFit fit;
  fit.position = start.position;
  fit.force = Eigen::VectorXd::Zero(start.position.size());
  fit.coefficients = start.coefficients;
  fit.multiplier = start.multiplier;
  const PositionFitInput input{model,
                               force_model,
                               start,
                               prior,
                               options,
                               HeldAxes(model),
                               NodeStiffness(equation, *model.body, start.position)};
  AssembledStep assembled(model, equation, &fit.position);
  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &assembled;
  ceres::Problem problem(problem_options);
  AddPositions(input, &fit, &problem);
  const std::vector<ceres::ResidualBlockId> observed =
      AddObservations(observations, options, &fit, &problem);
  AddBalance(input, assembled, &fit, &problem);
  AddCoefficientPrior(input, &fit, &problem);
  const ceres::Solver::Summary summary = SolveInOneThread(options, &problem);

  fit.factorisations = summary.num_linear_solves;
  fit.initial_cost = summary.initial_cost;
  fit.final_cost = summary.final_cost;
  fit.status = summary.termination_type == ceres::CONVERGENCE ? ForceFit::Status::kConverged
                                                              : ForceFit::Status::kNoConvergence;
  fit.message = summary.message;
  if (!summary.IsSolutionUsable()) return fit;
  SetForces(input, equation, &fit);
  fit.weighted_rms = WeightedRms(observed, &problem);
  return fit;
}

}  // namespace lacuna
