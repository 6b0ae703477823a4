// A sparse Cholesky factor in single precision, made to be a preconditioner.
//
// A ≈ L Lᵀ by the multifrontal method over an AssemblyTree, with dense kernels from OpenBLAS.
// Single precision halves the work of the factorisation and the memory that a solve has to read;
// what it loses, about 1e-7 of the condition number, conjugate gradients win back. Subtrees are
// eliminated at the same time, large fronts by several threads; results do not depend on their
// number.
#ifndef LACUNA_FEM_SUPERNODAL_FACTOR_H_
#define LACUNA_FEM_SUPERNODAL_FACTOR_H_

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "fem/assembly_tree.h"
#include "fem/block_matrix.h"
#include "fem/dense_front.h"

namespace lacuna {

class SupernodalFactor {
 public:
  // Symbolic analysis for all matrices of one pattern; `pattern` and `order` are read here only.
  SupernodalFactor(const BlockPattern& pattern, const EliminationOrder& order);

  // Anything but kPositive: there is no factor. kInDoubt means that the matrix may be too
  // ill-conditioned for single precision.
  Pivots Factorise(const BlockMatrix& matrix);

  // x = (L Lᵀ)⁻¹ b for a right-hand side of order one; both in *elimination order*
  // (`order().node`), of length 3·(free nodes). `b` and `x` may be the same.
  void Solve(const Eigen::VectorXf& b, Eigen::VectorXf* x);

  const EliminationOrder& order() const { return tree_.order; }
  double flops() const { return flops_; }                                 // of a factorisation
  double entries() const { return static_cast<double>(factor_.size()); }  // read twice by a solve

 private:
  // A 3 × 3 block of the matrix that is assembled into a front, `row` and `column` in nodes.
  struct Entry {
    int block = 0;
    int row = 0;
    int column = 0;
  };

  void PlaceInMemory();
  Pivots EliminateFront(int s, const BlockMatrix& matrix);
  void AssembleFront(int s, const BlockMatrix& matrix);
  void SolveForward(int s, const float* b);
  void SolveBackward(int s, float* x);
  // Calls visit(s) for each supernode, children first (or parents first), subtrees in parallel.
  template <typename Visit>
  void VisitUpwards(const Visit& visit) const;
  template <typename Visit>
  void VisitDownwards(const Visit& visit) const;

  AssemblyTree tree_;
  TreeCut cut_;
  std::vector<Entry> entries_;         // grouped by front
  std::vector<int64_t> entry_begin_;   // supernodes + 1
  std::vector<int64_t> panel_begin_;   // supernodes + 1: into factor_
  std::vector<int64_t> update_begin_;  // into updates_
  std::vector<int64_t> vector_begin_;  // supernodes + 1: into front_vectors_
  double flops_ = 0;
  float scale_ = 1;  // of the matrix, so that its entries are of order one

  // Front s of m rows and p columns: L as an m × p column-major panel (dense_front.h).
  std::vector<float> factor_;
  std::vector<float> updates_;        // Schur complements on their way to the parent
  std::vector<float> front_vectors_;  // right-hand sides on theirs
};

}  // namespace lacuna

#endif  // LACUNA_FEM_SUPERNODAL_FACTOR_H_
