// Sums in one written order, so that a search takes the same path whatever the compiler made of it.
//
// Eigen's reductions and products add in an order that depends on the width of the vector
// instructions they were compiled for, and a search turns a last bit into another path. A loop over
// doubles may not be reordered by a compiler that follows the standard; the module is compiled
// without contraction (-ffp-contract=off), and refuses to be compiled with -ffast-math.
#ifndef LACUNA_SEARCH_ORDERED_ALGEBRA_H_
#define LACUNA_SEARCH_ORDERED_ALGEBRA_H_

#include <Eigen/Core>
#include <cmath>
#include <optional>

#ifdef __FAST_MATH__
#error "src/search needs IEEE arithmetic: do not compile it with -ffast-math"
#endif

namespace lacuna {

template <typename A, typename B>
double OrderedDot(const A& a, const B& b) {
  double sum = 0;
  for (Eigen::Index i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

template <typename A>
double OrderedNorm(const A& a) {
  return std::sqrt(OrderedDot(a, a));
}

// a > b by more than rounding. Lengths in a simplex are often equal by construction (every full
// step has the length of the radius), and a choice between equals must not hang on their last bits.
inline bool ClearlyGreater(double a, double b) { return a > b + 1e-10 * std::abs(b); }

// M x.
Eigen::VectorXd OrderedProduct(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& vector);

// The inverse of a square matrix by elimination with row pivots; none where a pivot falls below
// 1e-14 of the largest entry of its column.
std::optional<Eigen::MatrixXd> OrderedInverse(Eigen::MatrixXd matrix);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_ORDERED_ALGEBRA_H_
