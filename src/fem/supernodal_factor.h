// A sparse Cholesky factor in single precision, for use as a preconditioner.
//
// Computes A ≈ L Lᵀ by the multifrontal method (assembly_tree.h) with dense kernels of OpenBLAS
// (dense_front.h). Single precision halves the work of the factorisation and the memory that a
// solve has to read; conjugate gradients recover the lost accuracy, a relative error of about 1e-7
// times the condition number. Subtrees are eliminated in parallel and large fronts by several
// threads; the results do not depend on the number of threads.
#ifndef LACUNA_FEM_SUPERNODAL_FACTOR_H_
#define LACUNA_FEM_SUPERNODAL_FACTOR_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "fem/assembly_tree.h"
#include "fem/block_matrix.h"
#include "fem/dense_front.h"

namespace lacuna {

// Not thread-safe: one object per simulation, because a solve uses internal working memory.
class SupernodalFactor {
 public:
  // Performs the symbolic analysis for all matrices of a pattern. No reference is kept. Throws
  // OutOfMemory where the factor does not fit into memory (core/memory_limit.h).
  SupernodalFactor(const BlockPattern& pattern, const EliminationOrder& order);

  // Computes the numeric factor. There is no usable factor unless the result is kPositive; kInDoubt
  // means that the matrix may be too ill-conditioned for single precision.
  Pivots Factorise(const BlockMatrix& matrix);

  // x = (L Lᵀ)⁻¹ b for a right-hand side of order one. Both have 3·(free nodes) entries in the
  // elimination order `order()`, and may be the same vector.
  void Solve(const Eigen::VectorXf& b, Eigen::VectorXf* x);

  const EliminationOrder& order() const { return tree_.order; }
  double flops() const { return flops_; }  // operations of a numeric factorisation
  double entries() const { return static_cast<double>(factor_.size()); }  // stored in L

 private:
  // A 3 × 3 block of the matrix and its place in a front, in nodes.
  struct Entry {
    int block = 0;
    int row = 0;
    int column = 0;
  };

  // Steps of the symbolic analysis: the entries of the matrix that each front receives, and the
  // places of panels, update matrices and vectors in memory.
  void ListEntries(const BlockPattern& pattern);
  void PlaceInMemory();
  // The front of supernode s is the sum of the entries of the matrix and of the update matrices of
  // the children; its columns are then eliminated.
  void AssembleFront(int s, const BlockMatrix& matrix);
  Pivots EliminateFront(int s, const BlockMatrix& matrix);
  // The substitutions at supernode s.
  void SolveForward(int s, const float* b);
  void SolveBackward(int s, float* x);
  // Call visit(s) for each supernode with children first, or with parents first; subtrees in
  // parallel.
  template <typename Visit>
  void VisitUpwards(const Visit& visit) const;
  template <typename Visit>
  void VisitDownwards(const Visit& visit) const;

  AssemblyTree tree_;
  TreeCut cut_;
  std::vector<Entry> entries_;         // grouped by front
  std::vector<int64_t> entry_begin_;   // supernodes + 1
  std::vector<int64_t> panel_begin_;   // supernodes + 1: first entry in factor_
  std::vector<int64_t> update_begin_;  // supernodes: first entry in updates_
  std::vector<int64_t> vector_begin_;  // supernodes + 1: first entry in front_vectors_
  double flops_ = 0;
  float scale_ = 1;  // factor that makes the entries of the matrix of order one

  // L: for each front of m rows and p columns a column-major m × p panel (dense_front.h).
  std::vector<float> factor_;
  std::vector<float> updates_;        // Schur complements for the fronts of the parents
  std::vector<float> front_vectors_;  // right-hand sides for the fronts of the parents
};

}  // namespace lacuna

#endif  // LACUNA_FEM_SUPERNODAL_FACTOR_H_
