// Solves A x = b for the symmetric matrices of one mesh, again and again.
//
// Symbolic analysis (METIS nested dissection) is done once per mesh and set of fixed nodes. A
// numeric Cholesky factor is the dearest thing in a time step, so it is made in single precision
// and kept: matrices are solved, to the accuracy asked for, by conjugate gradients in double
// precision preconditioned with the kept factor. It is renewed when a solve has cost more than the
// average since the factor was made, its making included; cost is counted in operations, so that
// results are the same on every run and for any number of threads.
#ifndef LACUNA_FEM_LINEAR_SOLVER_H_
#define LACUNA_FEM_LINEAR_SOLVER_H_

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "fem/block_matrix.h"

namespace lacuna {

struct LinearSolverOptions {
  enum class Method {
    kKeptFactor,  // CG preconditioned by a kept Cholesky factor
    kDirect,      // factorise every matrix anew
  };
  Method method = Method::kKeptFactor;
  double relative_tolerance = 1e-9;  // ‖b − A x‖ ≤ tolerance·‖b‖; smaller: more CG iterations
};

struct LinearSolveSummary {
  enum class Status { kNotRun, kSolved, kNotPositiveDefinite, kNoConvergence };
  Status status = Status::kNotRun;
  std::string message;
  int iterations = 0;            // of CG
  bool factorised = false;       // a numeric factorisation was needed
  double relative_residual = 0;  // ‖b − A x‖ / ‖b‖ reached
  bool IsUsable() const { return status == Status::kSolved; }
};

class LinearSolver {
 public:
  // `fixed[i]`: node i is prescribed; its rows and columns are left out and x is 0 there.
  LinearSolver(std::shared_ptr<const BlockPattern> pattern, const std::vector<char>& fixed,
               const LinearSolverOptions& options);
  ~LinearSolver();
  LinearSolver(LinearSolver&&) noexcept;
  LinearSolver& operator=(LinearSolver&&) noexcept;

  // Solves A x = b (length 3·nodes). `A` must be positive definite on the free nodes; if it is not
  // the summary says so and x is left at 0. (Conjugate gradients notice where they meet it: a
  // solution found without meeting a direction of negative curvature is reported as solved.)
  //
  // `node_rotations` (one per node, optional): how the body has turned about each node since a
  // configuration that is the same for all solves. A kept factor is then turned along, which keeps
  // it good when the matrix has changed mostly by rotation: A ≈ Q A₀ Qᵀ, Q = R R₀ᵀ node by node.
  LinearSolveSummary Solve(const BlockMatrix& A, const Eigen::VectorXd& b, Eigen::VectorXd* x,
                           const std::vector<Eigen::Matrix3d>* node_rotations = nullptr);

  // Tells the solver that the next matrix has little to do with the last one.
  void DropFactor();

  int factorisations() const;  // numeric factorisations so far

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_LINEAR_SOLVER_H_
