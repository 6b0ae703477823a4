// Dual numbers for forward-mode automatic differentiation (A. Griewank and A. Walther, Evaluating
// Derivatives, 2nd ed., SIAM 2008, ch. 3).
#ifndef LACUNA_CORE_DUAL_H_
#define LACUNA_CORE_DUAL_H_

#include <Eigen/Core>

namespace lacuna {

// A value and its derivatives in N directions. The members are not initialised by default.
template <int N>
struct Dual {
  double value;
  Eigen::Array<double, N, 1> derivative;

  // A number whose derivatives are zero.
  static Dual Constant(double value) { return {value, Eigen::Array<double, N, 1>::Zero()}; }
  // The independent variable of direction 0 <= `direction` < N: its derivative there is 1.
  static Dual Variable(double value, int direction) {
    Dual variable = Constant(value);
    variable.derivative[direction] = 1;
    return variable;
  }
};

}  // namespace lacuna

#endif  // LACUNA_CORE_DUAL_H_
