// A parsed formula as instructions for a stack machine, and their execution.
//
// core/expression.h describes the functions and their derivatives at kinks.
#ifndef LACUNA_CORE_EXPRESSION_PROGRAM_H_
#define LACUNA_CORE_EXPRESSION_PROGRAM_H_

#include <vector>

namespace lacuna {

// The operations in the order of the parser's table. kPower computes x^y and pow(x, y) alike.
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

// Pushes a value onto the stack, or replaces the topmost one or two values by the result of the
// operation.
struct Instruction {
  Operation operation;
  int variable;     // index among the variables, for kVariable
  double constant;  // for kConstant
};
using ExpressionProgram = std::vector<Instruction>;

// The most values that the stack can hold; the parser refuses deeper programs.
inline constexpr int kMaxStackDepth = 64;

// The number of values that the operation takes from the stack: 0, 1 or 2.
int Arity(Operation operation);

// The result of the instructions [begin, end), which must leave exactly one value on the stack.
// `Number` is double, Dual<1> or Dual<3>. Allocates nothing and may run in several threads at once.
// Gives NaN or infinity where the formula is undefined.
template <typename Number>
Number RunProgram(const Instruction* begin, const Instruction* end, const Number* variables);

}  // namespace lacuna

#endif  // LACUNA_CORE_EXPRESSION_PROGRAM_H_
