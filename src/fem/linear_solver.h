// Solves A x = b repeatedly for symmetric matrices on one mesh, as Newton's method needs.
//
// Symbolic analysis (METIS nested dissection) is performed once per mesh and set of held nodes.
// The numeric Cholesky factorisation is the most expensive part of a time step. It is therefore
// computed in single precision and kept for the following matrices: these are solved to the
// requested accuracy by conjugate gradients (CG) in double precision, preconditioned with the kept
// factor. The factor is renewed when a solve costs more than the average solve since the
// factorisation, including the cost of the factorisation itself. Costs are counted in operations
// rather than measured, so that results are the same on every run and for any number of threads.
#ifndef LACUNA_FEM_LINEAR_SOLVER_H_
#define LACUNA_FEM_LINEAR_SOLVER_H_

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "fem/block_matrix.h"
#include "fem/held_components.h"

namespace lacuna {

struct LinearSolverOptions {
  enum class Method {
    kKeptFactor,  // CG preconditioned by a kept Cholesky factor
    kDirect,      // a factorisation for every matrix
  };
  Method method = Method::kKeptFactor;
  // ‖b − A x‖ ≤ tolerance·‖b‖. Smaller values take more iterations.
  double relative_tolerance = 1e-9;
};

struct LinearSolveSummary {
  enum class Status { kNotRun, kSolved, kNotPositiveDefinite, kNoConvergence };
  Status status = Status::kNotRun;
  std::string message;
  int iterations = 0;            // iterations of CG
  bool factorised = false;       // whether a numeric factorisation was needed
  double relative_residual = 0;  // the achieved ‖b − A x‖ / ‖b‖
  bool IsUsable() const { return status == Status::kSolved; }
};

// Not thread-safe: one solver per simulation.
class LinearSolver {
 public:
  // The rows and columns of held components are left out and x is 0 there.
  LinearSolver(std::shared_ptr<const BlockPattern> pattern, const HeldComponents& held,
               const LinearSolverOptions& options);
  ~LinearSolver();
  LinearSolver(LinearSolver&&) noexcept;
  LinearSolver& operator=(LinearSolver&&) noexcept;

  // Solves A x = b (vectors of length 3·nodes, node-major). If `A` is not positive definite on the
  // free components, the status of the summary is kNotPositiveDefinite and x is 0. An indefinite
  // matrix is noticed only if conjugate gradients encounter a direction of negative curvature.
  //
  // `node_rotations` (optional, one per node) are the rotations R of the body at its nodes relative
  // to any configuration that is the same for all solves. The kept factor of A₀ is then rotated
  // with the body, A ≈ Q A₀ Qᵀ with Q = R R₀ᵀ at each node, which keeps it a good preconditioner
  // when the matrix has changed mainly by rotation. Nodes that are held in part are not rotated,
  // since that would mix held and free components.
  LinearSolveSummary Solve(const BlockMatrix& A, const Eigen::VectorXd& b, Eigen::VectorXd* x,
                           const std::vector<Eigen::Matrix3d>* node_rotations = nullptr);

  // The kept factor M ≈ A by itself, with which newton.h approaches a solution without assembling
  // A.
  bool KeepsFactors() const;  // whether the method does
  bool HasFactor() const;     // whether there is one
  // Replaces it by a factor of A; returns false, without a factor, if A is not positive definite.
  bool Factorise(const BlockMatrix& A, const std::vector<Eigen::Matrix3d>& node_rotations);
  // z = M⁻¹ r for the free components and 0 for the held ones, with M rotated with the nodes. The
  // held components of r must be 0. CHECKs that there is a factor.
  void ApplyFactor(const Eigen::VectorXd& r, const std::vector<Eigen::Matrix3d>& node_rotations,
                   Eigen::VectorXd* z);
  // Whether a new factor is expected to cost less than the applications of the kept one that are
  // still needed to reduce the residual from `present` to `target`, if they converge at the rate of
  // the past `applications`, which reduced it from `first` to `present`. Only the ratios of the
  // three norms matter, so that they may have any common unit.
  bool IsRenewalCheaper(int applications, double first, double present, double target) const;
  // Counts this many applications as one solve, for the decision when to renew the factor.
  void CountApplications(int applications);

  // Discards the kept factor, for a next matrix that differs much from the last one.
  void DropFactor();

  int factorisations() const;  // numeric factorisations so far

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_LINEAR_SOLVER_H_
