// A formula that a user writes, such as "-k * exp(-(z - z0)/d)", evaluated with its derivatives.
//
// Operators, from weakest to strongest: + and −; * and /; unary + and −; ^, which associates to the
// right (2^3^2 = 2^9) and binds tighter than a sign (−x^2 = −(x^2)). Numbers are written as 0.5, .5
// or 1e-3. The constant is pi, and the functions are
//   sin cos tan asin acos atan atan2(y, x) exp log sqrt abs tanh min(a, b) max(a, b) pow(a, b),
//   step(s) = 0 for s < 0, 1 for s ≥ 0,
//   smooth_step(s) = 3s² − 2s³ for 0 ≤ s ≤ 1, 0 below, 1 above.
// docs/expression.md describes them for users.
//
// Derivatives are exact, by dual numbers (forward mode; A. Griewank and A. Walther, Evaluating
// Derivatives, 2nd ed., SIAM 2008, ch. 3). At a kink the derivative is one-sided or zero: 0 for
// abs(0), that of the first argument for min and max at a tie, and 0 everywhere for step. An
// infinite slope contributes 0 if the derivative of its argument is 0, as in sqrt(0).
#ifndef LACUNA_CORE_EXPRESSION_H_
#define LACUNA_CORE_EXPRESSION_H_

#include <cstddef>
#include <string>
#include <vector>

#include "core/dual.h"
#include "core/expression_error.h"
#include "core/expression_program.h"

namespace lacuna {

// Immutable after construction; several threads may evaluate one object.
class Expression {
 public:
  // Parses `text` with the variables `names`. Throws ExpressionError with the column for a formula
  // that is not well formed, contains an unknown name, is nested too deeply, or has a constant part
  // that is not finite.
  Expression(const std::string& text, const std::vector<std::string>& names);

  // The value for the given values of the variables, in the order of their names. NaN or infinite
  // where the formula is undefined, e.g. for the logarithm of a negative number. Allocates no
  // memory. `Number` is double, or Dual<1> or Dual<3> to get derivatives along those of the
  // variables.
  template <typename Number>
  Number At(const Number* variables) const;

  // Whether the formula contains the variable with this index.
  bool Uses(size_t variable) const { return uses_[variable]; }

  const std::string& text() const { return text_; }

  // The names of all functions and constants, which a variable must not have.
  static const std::vector<std::string>& ReservedNames();
  // Whether `text` is a letter or underscore followed by letters, digits and underscores.
  static bool IsName(const std::string& text);

 private:
  std::string text_;
  ExpressionProgram program_;
  std::vector<bool> uses_;
};

}  // namespace lacuna

#endif  // LACUNA_CORE_EXPRESSION_H_
