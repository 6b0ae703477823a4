#include "fit/coefficient_fit.h"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "core/interrupt.h"
#include "fem/linear_solver.h"
#include "fem/newton.h"
#include "fem/node_rotations.h"
#include "fit/stop_on_interrupt.h"

namespace lacuna {
namespace {

constexpr double kBalanceTolerance = 1e-10;  // Newton residual relative to the acting forces
constexpr double kSolverTolerance = 1e-7;    // residual of the linear system of a Newton step
constexpr int kNewtonIterations = 30;
// The largest numbers of parts in which the unknowns are applied: at the start of the search, and
// for a trial of it, which may fail since a shorter one follows.
constexpr int kMaxPartsAtStart = 8, kMaxPartsOfTrial = 2;
// The radius of the trust region in which the first search starts (Ceres' default), and by how much
// more than the last radius of a search the next one starts with: its observations differ little.
constexpr double kTrustRegionRadius = 1e4, kTrustRegionGrowth = 10;
// Below this radius steps are those of steepest descent, and too short to tell a minimum.
constexpr double kSmallRadius = 1e-2;

LinearSolverOptions WithTolerance(double tolerance) {
  LinearSolverOptions options;
  options.relative_tolerance = tolerance;
  return options;
}

// Computes x(u), c(u) and their derivatives at the unknowns that Ceres is about to evaluate.
class BalancedMotion : public ceres::EvaluationCallback {
 public:
  BalancedMotion(const Model& model, const StepEquation& equation, const BalanceControl& control,
                 const Eigen::VectorXd& position, const Eigen::VectorXd& balanced,
                 const Eigen::VectorXd* unknowns)
      : equation_(equation),
        control_(control),
        unknowns_(unknowns),
        gripped_place_(position),
        newton_solver_(model.body->pattern, control.held(), WithTolerance(kSolverTolerance)),
        tangent_(model.body->pattern),
        differentiated_position_(position),
        differentiated_unknowns_(balanced),
        position_(position) {}

  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override {
    if (IsDifferentiatedHere()) {
      position_ = differentiated_position_;
      is_balanced_ = true;
      return;
    }
    if (new_evaluation_point) is_balanced_ = Balance() && IsStable();
    if (evaluate_jacobians && is_balanced_) is_balanced_ = Differentiate();
  }

  // Forgets earlier derivatives. A balance is sought from `position`, and in parts from `unknowns`.
  void StartFrom(const Eigen::VectorXd& position, const Eigen::VectorXd& unknowns) {
    differentiated_position_ = position;
    differentiated_unknowns_ = unknowns;
    derivative_.is_usable = false;
  }

  bool is_balanced() const { return is_balanced_; }
  const Eigen::VectorXd& position() const { return position_; }
  Eigen::VectorXd Coefficients() const { return control_.Coefficients(*unknowns_, position_); }
  const BalanceDerivative& derivative() const { return derivative_; }
  int factorisations() const { return newton_solver_.factorisations(); }

 private:
  bool IsDifferentiatedHere() const {
    return derivative_.is_usable && *unknowns_ == differentiated_unknowns_;
  }

  // Solves for the balance, starting with a step along the tangent from the latest differentiated
  // point. If this fails, the change of the unknowns is applied in increasingly many parts.
  bool Balance() {
    const Eigen::VectorXd& from = differentiated_unknowns_;
    int most = derivative_.is_usable ? kMaxPartsOfTrial : kMaxPartsAtStart;
    if (*unknowns_ == from) most = 1;
    for (int parts = 1; parts <= most; parts *= 2) {
      position_ = differentiated_position_;
      if (derivative_.is_usable && parts == 1) {
        position_ += derivative_.position * (*unknowns_ - from);
        control_.Place(*unknowns_, &position_);
      }
      bool solved = true;
      for (int part = 1; part <= parts && solved && !InterruptRequested(); ++part) {
        const double share = static_cast<double>(part) / parts;
        solved = BalanceAt(part == parts ? *unknowns_
                                         : Eigen::VectorXd(from + share * (*unknowns_ - from)));
      }
      if (InterruptRequested()) return false;
      if (solved) return true;
    }
    return false;
  }

  bool BalanceAt(const Eigen::VectorXd& unknowns) {
    const Eigen::VectorXd force = control_.Force(unknowns);
    Eigen::VectorXd target = gripped_place_;
    control_.Place(unknowns, &target);
    const NewtonProblem problem{equation_, force, control_.held(), kBalanceTolerance,
                                kNewtonIterations};
    return SolveByNewton(problem, target, &newton_solver_, &tangent_, &position_).IsUsable();
  }

  void AssembleTangent() { equation_.Tangent(position_, /*convexify=*/false, &tangent_); }

  // Whether the balance is a stable equilibrium. A static body has others too, such as one that is
  // about to snap through, from which the search would have no direction to go on.
  bool IsStable() {
    if (equation_.has_inertia()) return true;
    AssembleTangent();
    return newton_solver_.Factorise(tangent_, NodeRotations(equation_.body(), position_));
  }

  bool Differentiate() {
    if (equation_.has_inertia()) AssembleTangent();  // in statics IsStable has done so
    BalanceDerivative derivative = control_.Differentiate(tangent_, &newton_solver_);
    if (!derivative.is_usable) return false;
    derivative_ = std::move(derivative);
    differentiated_position_ = position_;
    differentiated_unknowns_ = *unknowns_;
    return true;
  }

  const StepEquation& equation_;
  const BalanceControl& control_;
  const Eigen::VectorXd* unknowns_;
  Eigen::VectorXd gripped_place_;
  LinearSolver newton_solver_;
  BlockMatrix tangent_;
  // The point of the derivatives; before the first, the position that the search starts from and
  // the unknowns that belong to it.
  Eigen::VectorXd differentiated_position_, differentiated_unknowns_;
  Eigen::VectorXd position_;
  BalanceDerivative derivative_;
  bool is_balanced_ = false;
};

// The whitened residual W (N x(u) − y) as a function of the unknowns.
class ReducedObservationCost : public ceres::CostFunction {
 public:
  ReducedObservationCost(const BalancedMotion& motion, const Observations& observations,
                         Eigen::Index j, Eigen::Index unknowns)
      : motion_(motion),
        observations_(observations),
        j_(j),
        rows_(WhitenedDirections(observations, j)) {
    set_num_residuals(static_cast<int>(rows_.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(unknowns));
  }

  bool Evaluate(double const* const* /*parameters*/, double* residuals,
                double** jacobians) const override {
    if (!motion_.is_balanced()) return false;
    const Eigen::Vector3d deviation = Deviation(observations_, j_, motion_.position());
    Eigen::Map<Eigen::VectorXd>(residuals, rows_.rows()) = rows_ * deviation;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    const Eigen::MatrixXd derivative =
        DeviationDerivative(observations_, j_, motion_.derivative().position);
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        jacobians[0], rows_.rows(), derivative.cols()) = rows_ * derivative;
    return true;
  }

 private:
  const BalancedMotion& motion_;
  const Observations& observations_;
  Eigen::Index j_;
  Eigen::Matrix<double, Eigen::Dynamic, 3> rows_;
};

// The deviation c(u) − c₀ from the prior as a function of the unknowns.
class CoefficientPriorCost : public ceres::CostFunction {
 public:
  CoefficientPriorCost(const BalancedMotion& motion, const Eigen::VectorXd& expected)
      : motion_(motion), expected_(expected) {
    set_num_residuals(static_cast<int>(expected.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(expected.size()));
  }

  bool Evaluate(double const* const* /*parameters*/, double* residuals,
                double** jacobians) const override {
    if (!motion_.is_balanced()) return false;
    const Eigen::Index count = expected_.size();
    Eigen::Map<Eigen::VectorXd>(residuals, count) = motion_.Coefficients() - expected_;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        jacobians[0], count, count) = motion_.derivative().coefficients;
    return true;
  }

 private:
  const BalancedMotion& motion_;
  Eigen::VectorXd expected_;
};

// Ends a search whose steps have become small (ForceFitOptions::immaterial_decrease). A body that
// cannot follow its observations leaves large residuals, with which the Gauss–Newton method
// converges only linearly.
class StopWhereImmaterial : public ceres::IterationCallback {
 public:
  explicit StopWhereImmaterial(double decrease) : decrease_(decrease) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    const bool ends =
        summary.iteration > 0 && summary.step_is_successful && summary.cost_change < decrease_;
    return ends ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  double decrease_;
};

// The whitened residuals of these blocks without their loss function; nothing where the balance
// cannot be found.
std::optional<std::vector<double>> ResidualsOf(const std::vector<ceres::ResidualBlockId>& blocks,
                                               ceres::Problem* problem) {
  ceres::Problem::EvaluateOptions options;
  options.residual_blocks = blocks;
  options.apply_loss_function = false;
  std::vector<double> residuals;
  if (!problem->Evaluate(options, nullptr, &residuals, nullptr, nullptr)) return std::nullopt;
  if (blocks.empty()) residuals.clear();  // to Ceres, no blocks means all of them
  return residuals;
}

double RootMeanSquare(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
}

// Sets the status of a fit whose search has a usable solution.
void SetStatus(const ceres::Solver::Summary& summary, ForceFit* fit) {
  if (summary.termination_type == ceres::CONVERGENCE ||
      summary.termination_type == ceres::USER_SUCCESS)
    fit->status = ForceFit::Status::kConverged;
  if (summary.termination_type == ceres::NO_CONVERGENCE)
    fit->status = ForceFit::Status::kEndedEarly;
  // Ceres takes steps that became short because no trial had a stable balance for convergence.
  const ceres::IterationSummary& last = summary.iterations.back();
  if (!last.step_is_successful && last.trust_region_radius < kSmallRadius) {
    fit->status = ForceFit::Status::kEndedEarly;
    fit->message = "no lower cost with a stable balance was found nearby";
  }
}

}  // namespace

struct CoefficientFitter::Implementation {
  Implementation(const Model& model, const StepEquation& equation, const ForceModel& force_model,
                 std::unique_ptr<BalanceControl> chosen, const Eigen::VectorXd& position,
                 const Eigen::VectorXd& coefficients)
      : equation(equation),
        basis(force_model.basis),
        start_coefficients(coefficients),
        control(std::move(chosen)),
        unknowns(control->Unknowns(position, coefficients)),
        motion(model, equation, *control, position,
               control->Unknowns(position, Eigen::VectorXd::Zero(coefficients.size())), &unknowns) {
  }

  // A start without a stable balance is replaced by the start of the step, with the coefficients
  // that were given.
  void EnsureStart() {
    motion.PrepareForEvaluation(/*evaluate_jacobians=*/true, /*new_evaluation_point=*/true);
    if (motion.is_balanced()) return;
    const Eigen::VectorXd& start = equation.start_position();
    unknowns = control->Unknowns(start, start_coefficients);
    motion.StartFrom(start, unknowns);
  }

  std::vector<ceres::ResidualBlockId> AddObservations(const Observations& observations,
                                                      const ForceFitOptions& options,
                                                      ceres::Problem* problem) {
    std::vector<ceres::ResidualBlockId> observed;
    for (Eigen::Index j = 0; j < observations.Count(); ++j) {
      ceres::LossFunction* loss =
          options.robust_threshold > 0 ? new ceres::HuberLoss(options.robust_threshold) : nullptr;
      observed.push_back(problem->AddResidualBlock(
          new ReducedObservationCost(motion, observations, j, unknowns.size()), loss,
          unknowns.data()));
    }
    return observed;
  }

  // Moves the unknowns to the minimum of the cost, as far as it is found.
  ceres::Solver::Summary Search(const ForceFitOptions& options, ceres::Problem* problem) {
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    solver.max_num_iterations = options.max_iterations;
    solver.function_tolerance = options.function_tolerance;
    solver.initial_trust_region_radius = trust_region_radius;
    solver.num_threads = 1;  // Ceres sums over threads in no fixed order
    solver.logging_type = ceres::SILENT;
    const std::unique_ptr<ceres::IterationCallback> stop = StopOnInterrupt();
    StopWhereImmaterial stop_where_immaterial(options.immaterial_decrease);
    solver.callbacks = {stop.get(), &stop_where_immaterial};
    ceres::Solver::Summary summary;
    ceres::Solve(solver, problem, &summary);
    ThrowIfInterrupted();
    if (!summary.iterations.empty()) {
      trust_region_radius =
          std::clamp(kTrustRegionGrowth * summary.iterations.back().trust_region_radius, 1.0,
                     kTrustRegionRadius);
    }
    return summary;
  }

  const StepEquation& equation;
  const Eigen::SparseMatrix<double, Eigen::RowMajor>& basis;
  Eigen::VectorXd start_coefficients;
  std::unique_ptr<BalanceControl> control;
  Eigen::VectorXd unknowns;
  BalancedMotion motion;
  double trust_region_radius = kTrustRegionRadius;  // in which the next search starts
};

CoefficientFitter::CoefficientFitter(const Model& model, const StepEquation& equation,
                                     const ForceModel& force_model,
                                     std::unique_ptr<BalanceControl> control,
                                     const Eigen::VectorXd& position,
                                     const Eigen::VectorXd& coefficients)
    : implementation_(std::make_unique<Implementation>(
          model, equation, force_model, std::move(control), position, coefficients)) {
  CHECK(!force_model.HasFreeNodes());
}

CoefficientFitter::~CoefficientFitter() = default;

ForceFit CoefficientFitter::Fit(const Observations& observations, const ForceFitPrior& prior,
                                const ForceFitOptions& options) {
  Implementation& kept = *implementation_;
  BalancedMotion& motion = kept.motion;
  const int factorisations_before = motion.factorisations();
  kept.EnsureStart();
  ForceFit fit;
  fit.multiplier = Eigen::VectorXd::Zero(motion.position().size());

  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &motion;
  ceres::Problem problem(problem_options);
  const std::vector<ceres::ResidualBlockId> observed =
      kept.AddObservations(observations, options, &problem);
  problem.AddResidualBlock(new CoefficientPriorCost(motion, prior.coefficients), nullptr,
                           kept.unknowns.data());
  const ceres::Solver::Summary summary = kept.Search(options, &problem);

  fit.factorisations = motion.factorisations() - factorisations_before;
  fit.initial_cost = summary.initial_cost;
  fit.final_cost = summary.final_cost;
  fit.message = summary.message;
  fit.status = ForceFit::Status::kNoConvergence;
  if (!summary.IsSolutionUsable()) return fit;
  // This evaluation also returns the motion to the best unknowns, which need not be the last ones
  // that were tried.
  const std::optional<std::vector<double>> residuals = ResidualsOf(observed, &problem);
  if (!residuals) return fit;
  fit.weighted_rms = RootMeanSquare(*residuals);
  fit.position = motion.position();
  fit.coefficients = motion.Coefficients();
  fit.force = kept.basis * fit.coefficients;
  SetStatus(summary, &fit);
  return fit;
}

}  // namespace lacuna
