// Linear algebra with a fixed order of summation, so that the path of a search does not depend on
// how the program is compiled.
//
// Eigen's reductions and products sum in an order that depends on the width of the vector
// instructions, and a difference in the last bit can change the path of a search. A compiler that
// follows the standard must not reorder a loop over doubles. The module is compiled without
// contraction (-ffp-contract=off) and cannot be compiled with -ffast-math.
#ifndef LACUNA_SEARCH_ORDERED_ALGEBRA_H_
#define LACUNA_SEARCH_ORDERED_ALGEBRA_H_

#include <Eigen/Core>
#include <cmath>
#include <optional>

#ifdef __FAST_MATH__
#error "src/search needs IEEE arithmetic: do not compile it with -ffast-math"
#endif

namespace lacuna {

// a · b, summed from the first entry to the last.
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

// Whether a exceeds b by more than rounding errors, that is by more than 1e-10 |b|. Lengths in a
// simplex are often equal by construction (every full step has the length of the radius), and a
// choice between equal lengths must not depend on their last bits.
inline bool ClearlyGreater(double a, double b) { return a > b + 1e-10 * std::abs(b); }

// The product of a matrix and a vector.
Eigen::VectorXd OrderedProduct(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& vector);

// The inverse of a square matrix by Gauss-Jordan elimination with row pivoting. Returns
// std::nullopt if a pivot does not exceed 1e-14 times the largest entry of its column in the given
// matrix.
std::optional<Eigen::MatrixXd> OrderedInverse(Eigen::MatrixXd matrix);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_ORDERED_ALGEBRA_H_
