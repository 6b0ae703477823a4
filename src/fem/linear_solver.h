// Solves A x = b for the symmetric matrices of one mesh, again and again.
//
// Symbolic analysis (METIS nested dissection) is done once per mesh and set of fixed nodes. A
// numeric Cholesky factor is the dearest thing in a time step, so it is kept: later matrices are
// solved by conjugate gradients preconditioned with the kept factor, which is renewed when the
// iterations it costs exceed what a new factor would.
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
  // the summary says so and x is left at 0.
  LinearSolveSummary Solve(const BlockMatrix& A, const Eigen::VectorXd& b, Eigen::VectorXd* x);

  // Tells the solver that the next matrix has little to do with the last one.
  void DropFactor();

  int factorisations() const;  // numeric factorisations so far

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_LINEAR_SOLVER_H_
