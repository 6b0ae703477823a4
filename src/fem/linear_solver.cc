#include "fem/linear_solver.h"

#include <cblas.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "fem/cholmod_factor.h"
#include "fem/elimination_order.h"
#include "fem/supernodal_factor.h"

namespace lacuna {
namespace {

using Status = LinearSolveSummary::Status;

// What things cost, in operations of a factorisation. A factorisation is bound by arithmetic, an
// iteration by memory: so many operations are done while one byte is read.
constexpr double kOperationsPerByte = 6;
constexpr int kMaxIterations = 1000;

}  // namespace

struct LinearSolver::Implementation {
  std::shared_ptr<const BlockPattern> pattern;
  LinearSolverOptions options;
  EliminationOrder order;

  // The factor at hand: single precision where that will do, else double.
  enum class Kept { kNone, kSingle, kDouble } kept = Kept::kNone;
  std::optional<SupernodalFactor> single_factor;
  std::optional<CholmodFactor> double_factor;
  bool single_precision_fails = false;
  std::vector<Eigen::Matrix3d> factor_rotations;  // when the factor was made; empty: not told

  int factorisations = 0;
  double factorisation_cost = 0, iteration_cost = 0;
  double spent = 0;  // since the factor was made, its own cost included
  int solves = 0;    // with the present factor

  std::vector<Eigen::Matrix3d> turn;  // since the factor was made; empty: none
  Eigen::VectorXf single_reduced;
  Eigen::VectorXd double_reduced, double_solution;
  Eigen::VectorXd residual, direction, product, preconditioned;

  Implementation(std::shared_ptr<const BlockPattern> block_pattern, const std::vector<char>& fixed,
                 const LinearSolverOptions& solver_options)
      : pattern(std::move(block_pattern)),
        options(solver_options),
        order(NestedDissection(*pattern, fixed)) {}

  bool Factorise(const BlockMatrix& A);
  bool FactoriseInDouble(const BlockMatrix& A);
  void ApplyFactor(const Eigen::VectorXd& r, Eigen::VectorXd* z);
  void MultiplyFree(const BlockMatrix& A, const Eigen::VectorXd& x, Eigen::VectorXd* y) const;
  void ZeroFixed(Eigen::VectorXd* v) const;
  void SetTurn(const std::vector<Eigen::Matrix3d>* rotations);

  enum class Outcome { kConverged, kNegativeCurvature, kTooManyIterations };
  Outcome Iterate(const BlockMatrix& A, double b_norm, int budget, Eigen::VectorXd* x,
                  LinearSolveSummary* summary);
  LinearSolveSummary Solve(const BlockMatrix& A, const Eigen::VectorXd& b, Eigen::VectorXd* x,
                           const std::vector<Eigen::Matrix3d>* rotations);
};

bool LinearSolver::Implementation::FactoriseInDouble(const BlockMatrix& A) {
  if (!double_factor) double_factor.emplace(*pattern, order);
  kept = double_factor->Factorise(A) ? Kept::kDouble : Kept::kNone;
  factorisation_cost = double_factor->flops();
  iteration_cost = kOperationsPerByte * 2 * sizeof(double) * double_factor->entries();
  return kept == Kept::kDouble;
}

bool LinearSolver::Implementation::Factorise(const BlockMatrix& A) {
  ++factorisations;
  solves = 0;
  bool made = false;
  if (options.method == LinearSolverOptions::Method::kKeptFactor && !single_precision_fails) {
    if (!single_factor) single_factor.emplace(*pattern, order);
    made = single_factor->Factorise(A);
    kept = made ? Kept::kSingle : Kept::kNone;
    factorisation_cost = single_factor->flops();
    iteration_cost = kOperationsPerByte * 2 * sizeof(float) * single_factor->entries();
  }
  if (!made) {
    made = FactoriseInDouble(A);
    // A matrix that is definite in double precision only tells of the next ones of this mesh.
    single_precision_fails = single_precision_fails || made;
  }
  iteration_cost += kOperationsPerByte * 9 * sizeof(double) * pattern->BlockCount();
  spent = factorisation_cost;
  return made;
}

// z = M⁻¹ r on the free nodes, 0 on the fixed ones.
void LinearSolver::Implementation::ApplyFactor(const Eigen::VectorXd& r, Eigen::VectorXd* z) {
  const auto turned_back = [&](int node) -> Eigen::Vector3d {
    if (turn.empty()) return r.segment<3>(3 * node);
    return turn[node].transpose() * r.segment<3>(3 * node);
  };
  const auto turn_forth = [&](int node, const Eigen::Vector3d& value) {
    z->segment<3>(3 * node) = turn.empty() ? value : Eigen::Vector3d(turn[node] * value);
  };
  z->setZero(r.size());
  if (kept == Kept::kSingle) {
    const std::vector<int>& nodes = single_factor->order().node;
    const int free_nodes = static_cast<int>(nodes.size());
    const double norm = r.norm();
    single_reduced.resize(3 * free_nodes);
    for (int k = 0; k < free_nodes; ++k) {
      single_reduced.segment<3>(3 * k) = (turned_back(nodes[k]) / norm).cast<float>();
    }
    single_factor->Solve(single_reduced, &single_reduced);
    for (int k = 0; k < free_nodes; ++k) {
      turn_forth(nodes[k], norm * single_reduced.segment<3>(3 * k).cast<double>());
    }
  } else {
    double_reduced.resize(3 * order.FreeNodes());
    for (int k = 0; k < order.FreeNodes(); ++k) {
      double_reduced.segment<3>(3 * k) = turned_back(order.node[k]);
    }
    double_factor->Solve(double_reduced, &double_solution);
    for (int k = 0; k < order.FreeNodes(); ++k) {
      turn_forth(order.node[k], double_solution.segment<3>(3 * k));
    }
  }
}

void LinearSolver::Implementation::MultiplyFree(const BlockMatrix& A, const Eigen::VectorXd& x,
                                                Eigen::VectorXd* y) const {
  A.Multiply(x, y);
  ZeroFixed(y);
}

void LinearSolver::Implementation::ZeroFixed(Eigen::VectorXd* v) const {
  for (int i = 0; i < pattern->nodes; ++i) {
    if (order.place[i] < 0) v->segment<3>(3 * i).setZero();
  }
}

void LinearSolver::Implementation::SetTurn(const std::vector<Eigen::Matrix3d>* rotations) {
  turn.clear();
  if (rotations == nullptr || factor_rotations.empty()) return;
  turn.resize(rotations->size());
  for (size_t i = 0; i < turn.size(); ++i) {
    turn[i] = (*rotations)[i] * factor_rotations[i].transpose();
  }
}

// Preconditioned conjugate gradients from the present *x, whose residual is in `residual`.
LinearSolver::Implementation::Outcome LinearSolver::Implementation::Iterate(
    const BlockMatrix& A, double b_norm, int budget, Eigen::VectorXd* x,
    LinearSolveSummary* summary) {
  const double target = options.relative_tolerance * b_norm;
  double rho_before = 0;
  for (int k = 0; !(residual.norm() <= target); ++k) {
    if (k == budget) return Outcome::kTooManyIterations;
    ApplyFactor(residual, &preconditioned);
    const double rho = residual.dot(preconditioned);
    if (k == 0) {
      direction = preconditioned;
    } else {
      direction = preconditioned + (rho / rho_before) * direction;
    }
    rho_before = rho;
    MultiplyFree(A, direction, &product);
    const double curvature = direction.dot(product);
    ++summary->iterations;
    spent += iteration_cost;
    if (!(curvature > 0)) return Outcome::kNegativeCurvature;
    const double step = rho / curvature;
    *x += step * direction;
    residual -= step * product;
  }
  return Outcome::kConverged;
}

LinearSolveSummary LinearSolver::Implementation::Solve(
    const BlockMatrix& A, const Eigen::VectorXd& b, Eigen::VectorXd* x,
    const std::vector<Eigen::Matrix3d>* rotations) {
  CHECK_EQ(A.shared_pattern().get(), pattern.get()) << "the matrix belongs to another mesh";
  CHECK_EQ(b.size(), 3 * pattern->nodes);
  LinearSolveSummary summary;
  x->setZero(b.size());
  residual = b;
  ZeroFixed(&residual);
  const double b_norm = residual.norm();
  if (b_norm == 0) {
    summary.status = Status::kSolved;
    return summary;
  }

  Outcome outcome = Outcome::kTooManyIterations;
  if (options.method == LinearSolverOptions::Method::kKeptFactor && kept != Kept::kNone) {
    SetTurn(rotations);
    const double average = spent / std::max(solves, 1);
    const double before = spent;
    const int budget = std::max(1, static_cast<int>(factorisation_cost / iteration_cost));
    outcome = Iterate(A, b_norm, budget, x, &summary);
    ++solves;
    // From here on keeping the factor would raise the average cost of a solve.
    if (spent - before > average) kept = Kept::kNone;
  }
  if (outcome != Outcome::kConverged) {
    summary.factorised = true;
    if (!Factorise(A)) {
      summary.status = Status::kNotPositiveDefinite;
      summary.message = "the matrix is not positive definite on the free nodes";
      x->setZero();
      return summary;
    }
    turn.clear();
    factor_rotations.clear();
    if (rotations != nullptr) factor_rotations = *rotations;
    outcome = Iterate(A, b_norm, kMaxIterations, x, &summary);
    ++solves;
  }
  summary.relative_residual = residual.norm() / b_norm;
  if (outcome == Outcome::kConverged) {
    summary.status = Status::kSolved;
  } else {
    summary.status = Status::kNoConvergence;
    summary.message = "conjugate gradients stopped at a relative residual of " +
                      std::to_string(summary.relative_residual);
  }
  return summary;
}

LinearSolver::LinearSolver(std::shared_ptr<const BlockPattern> pattern,
                           const std::vector<char>& fixed, const LinearSolverOptions& options)
    : implementation_(std::make_unique<Implementation>(std::move(pattern), fixed, options)) {
  // OpenBLAS's own threads would make the sums, and so the bits, depend on their number.
  openblas_set_num_threads(1);
}

LinearSolver::~LinearSolver() = default;
LinearSolver::LinearSolver(LinearSolver&&) noexcept = default;
LinearSolver& LinearSolver::operator=(LinearSolver&&) noexcept = default;

LinearSolveSummary LinearSolver::Solve(const BlockMatrix& A, const Eigen::VectorXd& b,
                                       Eigen::VectorXd* x,
                                       const std::vector<Eigen::Matrix3d>* node_rotations) {
  return implementation_->Solve(A, b, x, node_rotations);
}

void LinearSolver::DropFactor() { implementation_->kept = Implementation::Kept::kNone; }

int LinearSolver::factorisations() const { return implementation_->factorisations; }

}  // namespace lacuna
