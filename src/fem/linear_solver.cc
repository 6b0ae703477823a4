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
    if (KeepsFactors()) single_factor.emplace(*pattern, order);
  }

  bool KeepsFactors() const { return options.method == LinearSolverOptions::Method::kKeptFactor; }
  bool Factorise(const BlockMatrix& coupled);
  bool FactoriseInDouble(const BlockMatrix& A);
  void ApplyFactor(const Eigen::VectorXd& r, Eigen::VectorXd* z);
  void ApplySingleFactor(const Eigen::VectorXd& r, Eigen::VectorXd* z);
  void ApplyDoubleFactor(const Eigen::VectorXd& r, Eigen::VectorXd* z);
  // Qᵀ v and Q v for the part v of a nodal vector that belongs to a node, where Q is the rotation
  // of the node since the factorisation.
  Eigen::Vector3d RotatedBack(int node, const Eigen::VectorXd& nodal) const {
    if (rotation.empty()) return nodal.segment<3>(3 * node);
    return rotation[node].transpose() * nodal.segment<3>(3 * node);
  }
  Eigen::Vector3d RotatedForward(int node, const Eigen::Vector3d& value) const {
    if (rotation.empty()) return value;
    return rotation[node] * value;
  }
  void MultiplyFree(const BlockMatrix& A, const Eigen::VectorXd& x, Eigen::VectorXd* y) const;
  void SetRotation(const std::vector<Eigen::Matrix3d>* rotations);
  void SetFactorRotations(const std::vector<Eigen::Matrix3d>* rotations);
  void CountSolve(double spent_before);

  enum class Outcome { kConverged, kIndefinite, kTooManyIterations, kBrokenDown, kNoFactor };
  // Preconditioned conjugate gradients from the current *x, whose residual is in `residual`, until
  // ‖b − A x‖ is within the tolerance relative to `b_norm` = ‖b‖. With `may_renew` the iteration
  // ends early where a new factor is expected to be cheaper.
  Outcome Iterate(const BlockMatrix& A, double b_norm, bool may_renew, Eigen::VectorXd* x,
                  LinearSolveSummary* summary);
  // The same with the kept factor, which is rotated with the nodes.
  Outcome IterateWithKeptFactor(const BlockMatrix& A, double b_norm,
                                const std::vector<Eigen::Matrix3d>* rotations, Eigen::VectorXd* x,
                                LinearSolveSummary* summary);
  // The same with a new factor of A.
  Outcome IterateWithNewFactor(const BlockMatrix& A, double b_norm,
                               const std::vector<Eigen::Matrix3d>* rotations, Eigen::VectorXd* x,
                               LinearSolveSummary* summary);
  static void Report(Outcome outcome, LinearSolveSummary* summary);
  void Remember(const Eigen::VectorXd& solution);
  bool IsRenewalCheaper(int iterations, double first_residual, double present_residual,
                        double target) const;
  void StartFromEarlierSolutions(const BlockMatrix& A, Eigen::VectorXd* x);
  LinearSolveSummary Solve(const BlockMatrix& A, const Eigen::VectorXd& b, Eigen::VectorXd* x,
                           const std::vector<Eigen::Matrix3d>* rotations);
};

// Computes the factor of A in double precision. If A is not positive definite, `kept` becomes kNone
// and the result is false.
bool LinearSolver::Implementation::FactoriseInDouble(const BlockMatrix& A) {
  if (!double_factor) double_factor.emplace(*pattern, order);
  kept = double_factor->Factorise(A) ? Kept::kDouble : Kept::kNone;
  factorisation_cost =
      2 * (double_factor->flops() + kOperationsPerFactorEntry * double_factor->entries());
  iteration_cost = kOperationsPerByte * 2 * sizeof(double) * double_factor->entries();
  return kept == Kept::kDouble;
}

// Computes the factor of a matrix, in double precision where single precision does not suffice.
// Returns false, without a factor, if the matrix is not positive definite on the free components.
bool LinearSolver::Implementation::Factorise(const BlockMatrix& coupled) {
  const BlockMatrix& A = held.Decoupled(coupled);
  ++factorisations;
  solves = 0;
  Pivots pivots = Pivots::kInDoubt;
  if (KeepsFactors() && !single_precision_fails) {
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

// z = M⁻¹ r at the free nodes, 0 at those that are held along all axes.
void LinearSolver::Implementation::ApplyFactor(const Eigen::VectorXd& r, Eigen::VectorXd* z) {
  z->setZero(r.size());
  if (kept == Kept::kSingle)
    ApplySingleFactor(r, z);
  else
    ApplyDoubleFactor(r, z);
}

// The right-hand side is scaled to order one, which is within the range of single precision.
void LinearSolver::Implementation::ApplySingleFactor(const Eigen::VectorXd& r, Eigen::VectorXd* z) {
  const std::vector<int>& nodes = single_factor->order().node;
  const int free_nodes = static_cast<int>(nodes.size());
  const double norm = r.norm();
  single_reduced.resize(3 * free_nodes);
  for (int k = 0; k < free_nodes; ++k) {
    single_reduced.segment<3>(3 * k) = (RotatedBack(nodes[k], r) / norm).cast<float>();
  }
  single_factor->Solve(single_reduced, &single_reduced);
  for (int k = 0; k < free_nodes; ++k) {
    z->segment<3>(3 * nodes[k]) =
        RotatedForward(nodes[k], norm * single_reduced.segment<3>(3 * k).cast<double>());
  }
}

void LinearSolver::Implementation::ApplyDoubleFactor(const Eigen::VectorXd& r, Eigen::VectorXd* z) {
  double_reduced.resize(3 * order.FreeNodes());
  for (int k = 0; k < order.FreeNodes(); ++k) {
    double_reduced.segment<3>(3 * k) = RotatedBack(order.node[k], r);
  }
  double_factor->Solve(double_reduced, &double_solution);
  for (int k = 0; k < order.FreeNodes(); ++k) {
    z->segment<3>(3 * order.node[k]) =
        RotatedForward(order.node[k], double_solution.col(0).segment<3>(3 * k));
  }
}

// y = A x for the free components, 0 for the held ones.
void LinearSolver::Implementation::MultiplyFree(const BlockMatrix& A, const Eigen::VectorXd& x,
                                                Eigen::VectorXd* y) const {
  A.Multiply(x, y);
  held.ClearIn(*y);
}

// Sets the rotations of the nodes since the factorisation, given those relative to the common
// configuration (linear_solver.h).
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

// Sets the rotations of the nodes at which a new factor has been computed; the nodes have not
// rotated since.
void LinearSolver::Implementation::SetFactorRotations(
    const std::vector<Eigen::Matrix3d>* rotations) {
  rotation.clear();
  factor_rotations.clear();
  if (rotations != nullptr) factor_rotations = *rotations;
}

// Counts a solve with the kept factor, before which the cost since the factorisation was
// `spent_before`. Drops the factor if from now on keeping it would increase the average cost.
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

// Sets status and message, given the number of iterations and the achieved residual.
void LinearSolver::Implementation::Report(Outcome outcome, LinearSolveSummary* summary) {
  switch (outcome) {
    case Outcome::kConverged:
      summary->status = Status::kSolved;
      break;
    case Outcome::kIndefinite:
      summary->status = Status::kNotPositiveDefinite;
      summary->message = "the matrix is not positive definite on the free components";
      break;
    case Outcome::kTooManyIterations:
    case Outcome::kBrokenDown:
      summary->status = Status::kNoConvergence;
      summary->message = fmt::format(
          "conjugate gradients stopped after {} iterations at a relative residual of {:.2g}",
          summary->iterations, summary->relative_residual);
      break;
    case Outcome::kNoFactor:
      LOG(FATAL) << "the iteration has not been run";
  }
}

LinearSolver::Implementation::Outcome LinearSolver::Implementation::IterateWithKeptFactor(
    const BlockMatrix& A, double b_norm, const std::vector<Eigen::Matrix3d>* rotations,
    Eigen::VectorXd* x, LinearSolveSummary* summary) {
  SetRotation(rotations);
  const double before = spent;
  const Outcome outcome = Iterate(A, b_norm, /*may_renew=*/true, x, summary);
  CountSolve(before);
  return outcome;
}

LinearSolver::Implementation::Outcome LinearSolver::Implementation::IterateWithNewFactor(
    const BlockMatrix& A, double b_norm, const std::vector<Eigen::Matrix3d>* rotations,
    Eigen::VectorXd* x, LinearSolveSummary* summary) {
  summary->factorised = true;
  if (!Factorise(A)) return Outcome::kIndefinite;
  SetFactorRotations(rotations);
  const Outcome outcome = Iterate(A, b_norm, /*may_renew=*/false, x, summary);
  ++solves;
  return outcome;
}

void LinearSolver::Implementation::Remember(const Eigen::VectorXd& solution) {
  earlier_solutions.push_front(solution);
  if (earlier_solutions.size() > kRememberedSolutions) earlier_solutions.pop_back();
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
  Outcome outcome = Outcome::kNoFactor;
  if (KeepsFactors() && kept != Kept::kNone)
    outcome = IterateWithKeptFactor(A, b_norm, rotations, x, &summary);
  if (outcome != Outcome::kConverged && outcome != Outcome::kIndefinite)
    outcome = IterateWithNewFactor(A, b_norm, rotations, x, &summary);
  summary.relative_residual = residual.norm() / b_norm;
  Report(outcome, &summary);
  if (summary.IsUsable())
    Remember(*x);
  else
    x->setZero();
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

bool LinearSolver::KeepsFactors() const { return implementation_->KeepsFactors(); }

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
