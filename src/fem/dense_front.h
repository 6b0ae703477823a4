// Dense kernels on one front of a multifrontal Cholesky factorisation, in single precision.
//
// A front of m rows and p columns to be eliminated is a column-major m × p panel and the lower
// triangle of an (m−p) × (m−p) update matrix. Large fronts are cut into tiles for several threads;
// the tiles depend on the front's size alone, so results do not depend on the number of threads.
#ifndef LACUNA_FEM_DENSE_FRONT_H_
#define LACUNA_FEM_DENSE_FRONT_H_

namespace lacuna {

// What the pivots of a factorisation say about its matrix, whose entries are at most of order one.
enum class Pivots {
  kPositive,
  kInDoubt,   // one was not positive, but rounding may have made it so (or it is not a number)
  kNegative,  // one was more negative than rounding can explain: the matrix is not definite
};

// panel ← [L₁₁; L₂₁] with L₁₁ L₁₁ᵀ = its upper part, update ← update − L₂₁ L₂₁ᵀ. Blocks of a few
// columns on the diagonal of L₁₁ are stored inverted. Stops at the first pivot that is not
// positive.
Pivots EliminateColumns(int m, int p, float* panel, float* update);

// y ← [z; y₂ − L₂₁ z] with z = L₁₁⁻¹ y₁; y of length m.
void ForwardSubstitute(int m, int p, const float* panel, float* y);

// y₁ ← L₁₁⁻ᵀ (y₁ − L₂₁ᵀ y₂).
void BackwardSubstitute(int m, int p, const float* panel, float* y);

}  // namespace lacuna

#endif  // LACUNA_FEM_DENSE_FRONT_H_
