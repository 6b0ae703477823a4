// A formula that a user writes, such as "-k * exp(-(z - z0)/d)", evaluated with its derivatives.
//
// Operators, from weakest to strongest: + and −; * and /; unary + and −; ^ (from the right, so that
// 2^3^2 = 2^9 and −x^2 = −(x^2)). Numbers as in 0.5, .5 and 1e-3, the constant pi, and the
// functions
//   sin cos tan asin acos atan atan2(y, x) exp log sqrt abs tanh min(a, b) max(a, b) pow(a, b),
//   step(s) = 0 for s < 0, 1 for s ≥ 0,   smooth_step(s) = 3s² − 2s³ for 0 ≤ s ≤ 1, 0 below, 1
//   above.
// docs/expression.md tells users.
//
// Derivatives are exact, by dual numbers (forward mode; A. Griewank and A. Walther, Evaluating
// Derivatives, 2nd ed., SIAM 2008, ch. 3). At a kink they are those of one side: of abs(0) it is 0,
// of min and max that of the first argument at a tie, of step 0 everywhere. An infinite slope times
// no change, as in sqrt at 0 with an argument that does not vary, is 0.
#ifndef LACUNA_CORE_EXPRESSION_H_
#define LACUNA_CORE_EXPRESSION_H_

#include <Eigen/Core>
#include <stdexcept>
#include <string>
#include <vector>

namespace lacuna {

// A value and its derivatives in N directions; not initialised by itself.
template <int N>
struct Dual {
  double value;
  Eigen::Array<double, N, 1> derivative;

  static Dual Constant(double value) { return {value, Eigen::Array<double, N, 1>::Zero()}; }
  // A variable that is the direction of this number.
  static Dual Variable(double value, int direction) {
    Dual variable = Constant(value);
    variable.derivative[direction] = 1;
    return variable;
  }
};

// What is wrong with an expression. what() reads "column 9: unknown name …"; columns count
// characters from 1.
class ExpressionError : public std::invalid_argument {
 public:
  ExpressionError(int column, const std::string& message)
      : std::invalid_argument("column " + std::to_string(column) + ": " + message),
        column_(column) {}
  int column() const { return column_; }

 private:
  int column_;
};

class Expression {
 public:
  // Parses `text`, in which `names` stand for variables. Throws ExpressionError.
  Expression(const std::string& text, const std::vector<std::string>& names);

  // The value where the variables, in the order of their names, have these values. NaN or infinite
  // where it is not defined, e.g. for the logarithm of a negative number. Allocates nothing.
  // `Number`: double, or Dual<1> or Dual<3> for the derivatives along the variables' own.
  template <typename Number>
  Number At(const Number* variables) const;

  // Whether the variable of this number occurs.
  bool Uses(size_t variable) const { return uses_[variable]; }

  const std::string& text() const { return text_; }

  // Names that mean something by themselves: functions and constants.
  static const std::vector<std::string>& ReservedNames();
  // A letter or underscore, then letters, digits and underscores.
  static bool IsName(const std::string& text);

 private:
  class Parser;

  enum class Operation : char {
    kConstant,
    kVariable,
    kAdd,
    kSubtract,
    kMultiply,
    kDivide,
    kPower,
    kNegate,
    kSin,
    kCos,
    kTan,
    kAsin,
    kAcos,
    kAtan,
    kAtan2,
    kExp,
    kLog,
    kSqrt,
    kAbs,
    kTanh,
    kMin,
    kMax,
    kStep,
    kSmoothStep,
  };
  struct Function {
    const char* name;
    Operation operation;
    int arguments;
  };
  // Pushes a value, or replaces the topmost ones by what the operation makes of them.
  struct Instruction {
    Operation operation;
    int variable;
    double constant;
  };
  static constexpr int kMaxDepth = 64;  // of the stack

  static const std::vector<Function>& Functions();
  static int Arity(Operation operation);
  template <typename Number>
  static Number Run(const Instruction* begin, const Instruction* end, const Number* variables);
  template <typename Stack>
  static void ApplyToOne(Operation operation, Stack* stack);
  template <typename Stack>
  static void ApplyToTwo(Operation operation, Stack* stack);

  std::string text_;
  std::vector<Instruction> program_;
  std::vector<bool> uses_;
};

}  // namespace lacuna

#endif  // LACUNA_CORE_EXPRESSION_H_
