#include "fem/linear_solver.h"

#include <cblas.h>
#include <fmt/format.h>
#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

#include "fem/cholmod_factor.h"
#include "fem/elimination_order.h"
#include "fem/supernodal_factor.h"

namespace lacuna {
namespace {

using Status = LinearSolveSummary::Status;

// The cost model, in operations of a dense kernel. A factorisation is limited by these operations
// and by the assembly of its fronts, an iteration by the bytes that it reads. The constants were
// fitted to meshes of 10 000 to 200 000 tetrahedra on one core; the best time for a renewal depends
// on them only weakly.
constexpr double kOperationsPerFactorEntry = 200;
constexpr double kOperationsPerByte = 4;

constexpr int kMaxIterations = 1000;
// A product pᵀ A p below −kRounding ‖p‖ ‖A p‖ is certainly negative.
constexpr double kRounding = 1e-12;
// Iterations expected with a new factor, and iterations after which the rate of convergence is
// known.
constexpr int kIterationsWhenNew = 3;
constexpr int kIterationsToJudge = 4;
// Number of earlier solutions from whose combination the iteration starts.
constexpr int kRememberedSolutions = 3;

}  // namespace

struct LinearSolver::Implementation {
  std::shared_ptr<const BlockPattern> pattern;
  HeldComponents held;
  LinearSolverOptions options;
  EliminationOrder order;

  // The current factor, in single precision unless that fails.
  enum class Kept { kNone, kSingle, kDouble } kept = Kept::kNone;
  std::optional<SupernodalFactor> single_factor;
  std::optional<CholmodFactor> double_factor;
  bool single_precision_fails = false;
  std::vector<Eigen::Matrix3d> factor_rotations;  // node rotations at the factorisation, if given

  int factorisations = 0;
  double factorisation_cost = 0, iteration_cost = 0;
  double spent = 0;  // cost since the factorisation, including its own
  int solves = 0;    // number of solves with the current factor

  std::vector<Eigen::Matrix3d> rotation;  // rotation of each node since the factorisation, if any
  Eigen::VectorXf single_reduced;
  Eigen::VectorXd double_reduced;
  Eigen::MatrixXd double_solution;  // one column
  Eigen::VectorXd residual, direction, product, preconditioned;
  std::deque<Eigen::VectorXd> earlier_solutions;  // latest first

  Implementation(std::shared_ptr<const BlockPattern> block_pattern,
                 const HeldComponents& held_components, const LinearSolverOptions& solver_options)
      : pattern(std::move(block_pattern)),
        held(held_components),
        options(solver_options),
        order(NestedDissection(*pattern, held.whole_nodes())) {
    if (options.method == LinearSolverOptions::Method::kKeptFactor) {
      single_factor.emplace(*pattern, order);
    }
  }

  bool Factorise(const BlockMatrix& coupled);
  bool FactoriseInDouble(const BlockMatrix& A);
  void ApplyFactor(const Eigen::VectorXd& r, Eigen::VectorXd* z);
  void MultiplyFree(const BlockMatrix& A, const Eigen::VectorXd& x, Eigen::VectorXd* y) const;
  void SetRotation(const std::vector<Eigen::Matrix3d>* rotations);
  void SetFactorRotations(const std::vector<Eigen::Matrix3d>* rotations);
  void CountSolve(double spent_before);

  enum class Outcome { kConverged, kIndefinite, kTooManyIterations, kBrokenDown };
  Outcome Iterate(const BlockMatrix& A, double b_norm, bool may_renew, Eigen::VectorXd* x,
                  LinearSolveSummary* summary);
  bool IsRenewalCheaper(int iterations, double first_residual, double present_residual,
                        double target) const;
  void StartFromEarlierSolutions(const BlockMatrix& A, Eigen::VectorXd* x);
  LinearSolveSummary Solve(const BlockMatrix& A, const Eigen::VectorXd& b, Eigen::VectorXd* x,
                           const std::vector<Eigen::Matrix3d>* rotations);
};

// Computes the factor of A; `kept` becomes kNone if A is not positive definite.
bool LinearSolver::Implementation::FactoriseInDouble(const BlockMatrix& A) {
  if (!double_factor) double_factor.emplace(*pattern, order);
  kept = double_factor->Factorise(A) ? Kept::kDouble : Kept::kNone;
  factorisation_cost =
      2 * (double_factor->flops() + kOperationsPerFactorEntry * double_factor->entries());
  iteration_cost = kOperationsPerByte * 2 * sizeof(double) * double_factor->entries();
  return kept == Kept::kDouble;
}

bool LinearSolver::Implementation::Factorise(const BlockMatrix& coupled) {
  const BlockMatrix& A = held.Decoupled(coupled);
  ++factorisations;
  solves = 0;
  Pivots pivots = Pivots::kInDoubt;
  if (options.method == LinearSolverOptions::Method::kKeptFactor && !single_precision_fails) {
    pivots = single_factor->Factorise(A);
    kept = pivots == Pivots::kPositive ? Kept::kSingle : Kept::kNone;
    factorisation_cost =
        single_factor->flops() + kOperationsPerFactorEntry * single_factor->entries();
    iteration_cost = kOperationsPerByte * 2 * sizeof(float) * single_factor->entries();
  }
  if (pivots == Pivots::kInDoubt && FactoriseInDouble(A)) {
    // The next matrices of this mesh are expected to need double precision as well.
    single_precision_fails = true;
  }
  iteration_cost += kOperationsPerByte * 9 * sizeof(double) * pattern->BlockCount();
  spent = factorisation_cost;
  return kept != Kept::kNone;
}

// z = M⁻¹ r on the free nodes, 0 on the fixed ones.
void LinearSolver::Implementation::ApplyFactor(const Eigen::VectorXd& r, Eigen::VectorXd* z) {
  const auto rotated_back = [&](int node) -> Eigen::Vector3d {
    if (rotation.empty()) return r.segment<3>(3 * node);
    return rotation[node].transpose() * r.segment<3>(3 * node);
  };
  const auto rotate_forward = [&](int node, const Eigen::Vector3d& value) {
    z->segment<3>(3 * node) = rotation.empty() ? value : Eigen::Vector3d(rotation[node] * value);
  };
  z->setZero(r.size());
  if (kept == Kept::kSingle) {
    const std::vector<int>& nodes = single_factor->order().node;
    const int free_nodes = static_cast<int>(nodes.size());
    const double norm = r.norm();
    single_reduced.resize(3 * free_nodes);
    for (int k = 0; k < free_nodes; ++k) {
      single_reduced.segment<3>(3 * k) = (rotated_back(nodes[k]) / norm).cast<float>();
    }
    single_factor->Solve(single_reduced, &single_reduced);
    for (int k = 0; k < free_nodes; ++k) {
      rotate_forward(nodes[k], norm * single_reduced.segment<3>(3 * k).cast<double>());
    }
  } else {
    double_reduced.resize(3 * order.FreeNodes());
    for (int k = 0; k < order.FreeNodes(); ++k) {
      double_reduced.segment<3>(3 * k) = rotated_back(order.node[k]);
    }
    double_factor->Solve(double_reduced, &double_solution);
    for (int k = 0; k < order.FreeNodes(); ++k) {
      rotate_forward(order.node[k], double_solution.col(0).segment<3>(3 * k));
    }
  }
}

void LinearSolver::Implementation::MultiplyFree(const BlockMatrix& A, const Eigen::VectorXd& x,
                                                Eigen::VectorXd* y) const {
  A.Multiply(x, y);
  held.ClearIn(*y);
}

void LinearSolver::Implementation::SetRotation(const std::vector<Eigen::Matrix3d>* rotations) {
  rotation.clear();
  if (rotations == nullptr || factor_rotations.empty()) return;
  rotation.resize(rotations->size());
  for (size_t i = 0; i < rotation.size(); ++i) {
    if (held.HoldsPart(static_cast<int>(i)))
      rotation[i].setIdentity();
    else
      rotation[i] = (*rotations)[i] * factor_rotations[i].transpose();
  }
}

// Sets the rotations of the nodes at which a new factor has been computed.
void LinearSolver::Implementation::SetFactorRotations(
    const std::vector<Eigen::Matrix3d>* rotations) {
  rotation.clear();
  factor_rotations.clear();
  if (rotations != nullptr) factor_rotations = *rotations;
}

// Drops the factor if from now on keeping it would increase the average cost of a solve.
void LinearSolver::Implementation::CountSolve(double spent_before) {
  const double average = spent_before / std::max(solves, 1);
  ++solves;
  if (solves > 1 && spent - spent_before > average) kept = Kept::kNone;
}

// Starts from the combination of earlier solutions with the smallest error in the energy norm
// (Fischer 1998) and stores its residual in `residual`. Since motion is smooth, this gains one or
// two digits for a few products with A.
void LinearSolver::Implementation::StartFromEarlierSolutions(const BlockMatrix& A,
                                                             Eigen::VectorXd* x) {
  const int count = static_cast<int>(earlier_solutions.size());
  if (count == 0) return;
  Eigen::MatrixXd image(residual.size(), count);
  for (int k = 0; k < count; ++k) {
    MultiplyFree(A, earlier_solutions[k], &product);
    image.col(k) = product;
  }
  Eigen::MatrixXd energy(count, count);
  Eigen::VectorXd work(count);
  for (int k = 0; k < count; ++k) {
    energy.col(k) = image.transpose() * earlier_solutions[k];
    work[k] = earlier_solutions[k].dot(residual);
  }
  const Eigen::LDLT<Eigen::MatrixXd> factor(0.5 * (energy + energy.transpose()));
  if (factor.info() != Eigen::Success || !factor.isPositive()) return;
  const Eigen::VectorXd weight = factor.solve(work);
  const Eigen::VectorXd reduced = residual - image * weight;
  if (!(reduced.norm() < residual.norm())) return;
  residual = reduced;
  for (int k = 0; k < count; ++k) *x += weight[k] * earlier_solutions[k];
}

// Whether a new factorisation would be cheaper than finishing the iteration at its rate so far.
bool LinearSolver::Implementation::IsRenewalCheaper(int iterations, double first_residual,
                                                    double present_residual, double target) const {
  const double digits_gained = std::log(first_residual / present_residual);
  const double digits_missing = std::log(present_residual / target);
  const double iterations_missing = digits_missing * iterations / std::max(digits_gained, 1e-3);
  return iterations_missing * iteration_cost >
         factorisation_cost + kIterationsWhenNew * iteration_cost;
}

// Preconditioned conjugate gradients from the current *x, whose residual is in `residual`.
LinearSolver::Implementation::Outcome LinearSolver::Implementation::Iterate(
    const BlockMatrix& A, double b_norm, bool may_renew, Eigen::VectorXd* x,
    LinearSolveSummary* summary) {
  const double target = options.relative_tolerance * b_norm;
  const double first_norm = residual.norm();
  double rho_before = 0;
  for (int k = 0;; ++k) {
    const double norm = residual.norm();
    if (norm <= target) return Outcome::kConverged;
    if (may_renew && k >= kIterationsToJudge && IsRenewalCheaper(k, first_norm, norm, target))
      return Outcome::kTooManyIterations;
    if (k == kMaxIterations) return Outcome::kTooManyIterations;
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
    if (!(curvature > 0)) {
      const double rounding = kRounding * direction.norm() * product.norm();
      return curvature < -rounding ? Outcome::kIndefinite : Outcome::kBrokenDown;
    }
    const double step = rho / curvature;
    *x += step * direction;
    residual -= step * product;
  }
}

LinearSolveSummary LinearSolver::Implementation::Solve(
    const BlockMatrix& A, const Eigen::VectorXd& b, Eigen::VectorXd* x,
    const std::vector<Eigen::Matrix3d>* rotations) {
  CHECK_EQ(A.shared_pattern().get(), pattern.get()) << "the matrix belongs to another mesh";
  CHECK_EQ(b.size(), 3 * pattern->nodes);
  LinearSolveSummary summary;
  x->setZero(b.size());
  residual = b;
  held.ClearIn(residual);
  const double b_norm = residual.norm();
  if (b_norm == 0) {
    summary.status = Status::kSolved;
    return summary;
  }

  StartFromEarlierSolutions(A, x);
  Outcome outcome = Outcome::kTooManyIterations;
  if (options.method == LinearSolverOptions::Method::kKeptFactor && kept != Kept::kNone) {
    SetRotation(rotations);
    const double before = spent;
    outcome = Iterate(A, b_norm, /*may_renew=*/true, x, &summary);
    CountSolve(before);
  }
  if (outcome == Outcome::kTooManyIterations || outcome == Outcome::kBrokenDown) {
    summary.factorised = true;
    if (Factorise(A)) {
      SetFactorRotations(rotations);
      outcome = Iterate(A, b_norm, /*may_renew=*/false, x, &summary);
      ++solves;
    } else {
      outcome = Outcome::kIndefinite;
    }
  }
  summary.relative_residual = residual.norm() / b_norm;
  switch (outcome) {
    case Outcome::kConverged:
      summary.status = Status::kSolved;
      earlier_solutions.push_front(*x);
      if (earlier_solutions.size() > kRememberedSolutions) earlier_solutions.pop_back();
      break;
    case Outcome::kIndefinite:
      summary.status = Status::kNotPositiveDefinite;
      summary.message = "the matrix is not positive definite on the free components";
      break;
    case Outcome::kTooManyIterations:
    case Outcome::kBrokenDown:
      summary.status = Status::kNoConvergence;
      summary.message = fmt::format(
          "conjugate gradients stopped after {} iterations at a relative "
          "residual of {:.2g}",
          summary.iterations, summary.relative_residual);
  }
  if (!summary.IsUsable()) x->setZero();
  return summary;
}

LinearSolver::LinearSolver(std::shared_ptr<const BlockPattern> pattern, const HeldComponents& held,
                           const LinearSolverOptions& options)
    : implementation_(std::make_unique<Implementation>(std::move(pattern), held, options)) {
  // With threads of OpenBLAS, the rounding of sums would depend on their number.
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

bool LinearSolver::KeepsFactors() const {
  return implementation_->options.method == LinearSolverOptions::Method::kKeptFactor;
}

bool LinearSolver::HasFactor() const {
  return implementation_->kept != Implementation::Kept::kNone;
}

bool LinearSolver::Factorise(const BlockMatrix& A,
                             const std::vector<Eigen::Matrix3d>& node_rotations) {
  if (!implementation_->Factorise(A)) return false;
  implementation_->SetFactorRotations(&node_rotations);
  return true;
}

void LinearSolver::ApplyFactor(const Eigen::VectorXd& r,
                               const std::vector<Eigen::Matrix3d>& node_rotations,
                               Eigen::VectorXd* z) {
  CHECK(HasFactor());
  implementation_->SetRotation(&node_rotations);
  implementation_->ApplyFactor(r, z);
}

bool LinearSolver::IsRenewalCheaper(int applications, double first, double present,
                                    double target) const {
  return implementation_->IsRenewalCheaper(applications, first, present, target);
}

void LinearSolver::CountApplications(int applications) {
  const double before = implementation_->spent;
  implementation_->spent += applications * implementation_->iteration_cost;
  implementation_->CountSolve(before);
}

void LinearSolver::DropFactor() { implementation_->kept = Implementation::Kept::kNone; }

int LinearSolver::factorisations() const { return implementation_->factorisations; }

}  // namespace lacuna
