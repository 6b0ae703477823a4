// Solves with the tangents of the steps of a motion for many right-hand sides.
//
// The tangent is K + S, with a symmetric part K and, for loads that turn with the body (effect.h),
// a skew-symmetric part S. K is factorised and S is treated by iterative refinement until the
// residual is negligible. If K is not definite or the iteration does not converge, a definite
// approximation of K is factorised in its place, and if that does not converge either, the whole
// tangent (unsymmetric_factor.h).
#ifndef LACUNA_FEM_TANGENT_SOLVER_H_
#define LACUNA_FEM_TANGENT_SOLVER_H_

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>

#include "core/parallel.h"
#include "fem/block_matrix.h"
#include "fem/free_component_factor.h"
#include "fem/held_components.h"
#include "fem/unsymmetric_factor.h"

namespace lacuna {

// Consecutive columns that are computed together, so that they stay in a core's cache from one
// operation to the next. The number is fixed, because the iterations of a group end together.
struct ColumnGroup {
  static constexpr Eigen::Index kSize = 16;  // columns; the last group may have fewer
  Eigen::Index first = 0, count = 0;

  // These columns of a matrix.
  template <typename Matrix>
  auto Of(Matrix& matrix) const {
    return matrix.middleCols(first, count);
  }
};

// Calls visit(group) for the groups of a matrix with `columns` columns, possibly at the same time
// for several of them.
template <typename Visit>
void ForEachGroup(Eigen::Index columns, const Visit& visit) {
  ParallelBlocks(columns, ColumnGroup::kSize, [&](int64_t begin, int64_t end) {
    visit(ColumnGroup{begin, static_cast<Eigen::Index>(end - begin)});
  });
}

// A linear system (K + S) s = right, 3n × columns; the functions may be called by several threads.
struct TangentSystem {
  const BlockMatrix& tangent;    // K
  const BlockMatrix* skew;       // S; null: 0
  const Eigen::MatrixXd& right;  // its held components are not used
  // Values near the solution of a group, with which the refinement begins.
  std::function<Eigen::MatrixXd(const ColumnGroup&)> expected;
  // A definite approximation of K.
  std::function<BlockMatrix()> approximation;
};

// Not thread-safe: one object per simulation.
class TangentSolver {
 public:
  // For matrices of this pattern. The residual of each column is reduced to `tolerance` relative to
  // its right-hand side. Larger values take fewer iterations.
  TangentSolver(const BlockPattern& pattern, HeldComponents held, double tolerance);

  const HeldComponents& held() const { return factor_.held(); }

  // Adds the solution at the free components to `sum` (3n × columns). Returns false where the
  // tangent is singular; `sum` is then incomplete.
  bool AddSolution(const TangentSystem& system, Eigen::MatrixXd* sum);

 private:
  // The solution of a group, by the factor of K, of its approximation, or of the whole tangent. No
  // value if it does not reach the tolerance.
  std::optional<Eigen::MatrixXd> SolveByTangent(const TangentSystem& system,
                                                const ColumnGroup& group) const;
  std::optional<Eigen::MatrixXd> SolveByApproximation(const TangentSystem& system,
                                                      const ColumnGroup& group) const;
  std::optional<Eigen::MatrixXd> SolveByWhole(const UnsymmetricFactor& whole,
                                              const TangentSystem& system,
                                              const ColumnGroup& group) const;
  template <typename Update>
  std::optional<Eigen::MatrixXd> Refine(const Eigen::MatrixXd& wanted, Eigen::MatrixXd residual,
                                        const Update& update) const;

  FreeComponentFactor factor_;
  double tolerance_;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_TANGENT_SOLVER_H_
