// Dense kernels for one front of a multifrontal Cholesky factorisation, in single precision.
//
// A front with m rows, of which the first p are eliminated, consists of a column-major m × p panel
// and the lower triangle of an (m − p) × (m − p) update matrix. Large fronts are processed in tiles
// by several threads. The tiles depend on the size of the front only, and so do the results.
#ifndef LACUNA_FEM_DENSE_FRONT_H_
#define LACUNA_FEM_DENSE_FRONT_H_

namespace lacuna {

// Whether the pivots show a matrix, with entries at most of order one, to be positive definite.
enum class Pivots {
  kPositive,
  kInDoubt,   // a pivot is not positive, possibly because of rounding, or it is not finite
  kNegative,  // a pivot is more negative than rounding can explain: the matrix is not definite
};

// Eliminates p columns: panel ← [L₁₁; L₂₁], where L₁₁ L₁₁ᵀ is the upper p × p part of the panel,
// and update ← update − L₂₁ L₂₁ᵀ. Diagonal blocks of a few columns of L₁₁ are stored as their
// inverses. Stops at the first pivot that is not positive and leaves panel and update in an
// undefined state.
Pivots EliminateColumns(int m, int p, float* panel, float* update);

// Forward substitution on a vector y = [y₁; y₂] of length m: y ← [z; y₂ − L₂₁ z] with z = L₁₁⁻¹ y₁.
void ForwardSubstitute(int m, int p, const float* panel, float* y);

// Backward substitution: y₁ ← L₁₁⁻ᵀ (y₁ − L₂₁ᵀ y₂).
void BackwardSubstitute(int m, int p, const float* panel, float* y);

}  // namespace lacuna

#endif  // LACUNA_FEM_DENSE_FRONT_H_
