#include "fem/linear_solver.h"

#include <cblas.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "fem/cholmod_factor.h"
#include "fem/elimination_order.h"

namespace lacuna {
namespace {

using Status = LinearSolveSummary::Status;

// How long a step takes is counted, not measured, so that the moment of renewal, and with it every
// bit of the result, is the same on each run: a factorisation is bound by arithmetic, an iteration
// by memory, and a processor core does about so many operations while it reads one byte.
constexpr double kFlopsPerByte = 2;
constexpr int kMaxIterations = 1000;

struct Costs {
  double factorisation = 0, iteration = 0;  // flops
};

}  // namespace

struct LinearSolver::Implementation {
  std::shared_ptr<const BlockPattern> pattern;
  LinearSolverOptions options;
  EliminationOrder order;
  std::optional<CholmodFactor> factor;  // none when all nodes are fixed
  Costs costs;

  bool has_factor = false;
  int factorisations = 0;
  double spent = 0;  // since the factor was made, its own cost included
  int solves = 0;    // with the present factor
  Eigen::VectorXd reduced, reduced_solution;
  Eigen::VectorXd residual, direction, product, preconditioned;

  Implementation(std::shared_ptr<const BlockPattern> block_pattern, const std::vector<char>& fixed,
                 const LinearSolverOptions& solver_options)
      : pattern(std::move(block_pattern)),
        options(solver_options),
        order(NestedDissection(*pattern, fixed)) {
    if (order.FreeNodes() == 0) return;
    factor.emplace(*pattern, order);
    costs.factorisation = factor->flops();
    costs.iteration =
        kFlopsPerByte * sizeof(double) * (2 * factor->entries() + 9.0 * pattern->BlockCount());
    reduced.resize(3 * order.FreeNodes());
  }

  bool Factorise(const BlockMatrix& A) {
    ++factorisations;
    has_factor = factor->Factorise(A);
    spent = costs.factorisation;
    solves = 0;
    return has_factor;
  }

  // z = (L Lᵀ)⁻¹ r on the free nodes, 0 on the fixed ones.
  void ApplyFactor(const Eigen::VectorXd& r, Eigen::VectorXd* z) {
    for (int k = 0; k < order.FreeNodes(); ++k) {
      reduced.segment<3>(3 * k) = r.segment<3>(3 * order.node[k]);
    }
    factor->Solve(reduced, &reduced_solution);
    z->setZero(r.size());
    for (int k = 0; k < order.FreeNodes(); ++k) {
      z->segment<3>(3 * order.node[k]) = reduced_solution.segment<3>(3 * k);
    }
  }

  void MultiplyFree(const BlockMatrix& A, const Eigen::VectorXd& x, Eigen::VectorXd* y) {
    A.Multiply(x, y);
    ZeroFixed(y);
  }

  void ZeroFixed(Eigen::VectorXd* v) const {
    for (int i = 0; i < pattern->nodes; ++i) {
      if (order.place[i] < 0) v->segment<3>(3 * i).setZero();
    }
  }

  LinearSolveSummary Solve(const BlockMatrix& A, const Eigen::VectorXd& b, Eigen::VectorXd* x);
  enum class Outcome { kConverged, kNegativeCurvature, kTooManyIterations };
  Outcome Iterate(const BlockMatrix& A, double b_norm, int budget, Eigen::VectorXd* x,
                  LinearSolveSummary* summary);
};

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
    spent += costs.iteration;
    if (!(curvature > 0)) return Outcome::kNegativeCurvature;
    const double step = rho / curvature;
    *x += step * direction;
    residual -= step * product;
  }
  return Outcome::kConverged;
}

LinearSolveSummary LinearSolver::Implementation::Solve(const BlockMatrix& A,
                                                       const Eigen::VectorXd& b,
                                                       Eigen::VectorXd* x) {
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
  if (options.method == LinearSolverOptions::Method::kKeptFactor && has_factor) {
    const double average = spent / std::max(solves, 1);
    const double before = spent;
    const int budget = std::max(1, static_cast<int>(costs.factorisation / costs.iteration));
    outcome = Iterate(A, b_norm, budget, x, &summary);
    ++solves;
    // The factor is renewed when the last solve cost more than the average since it was made:
    // from then on keeping it would raise the average.
    if (spent - before > average) has_factor = false;
  }
  if (outcome != Outcome::kConverged) {
    summary.factorised = true;
    if (!Factorise(A)) {
      summary.status = Status::kNotPositiveDefinite;
      summary.message = "the matrix is not positive definite on the free nodes";
      x->setZero();
      return summary;
    }
    // With a factor of A itself the first iteration is the direct solution, the next ones refine.
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
                                       Eigen::VectorXd* x) {
  return implementation_->Solve(A, b, x);
}

void LinearSolver::DropFactor() { implementation_->has_factor = false; }

int LinearSolver::factorisations() const { return implementation_->factorisations; }

}  // namespace lacuna
