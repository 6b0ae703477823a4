// A parsed formula as instructions for a stack machine, and the execution of the instructions.
//
// core/expression.h describes the functions and their derivatives at kinks.
#ifndef LACUNA_CORE_EXPRESSION_PROGRAM_H_
#define LACUNA_CORE_EXPRESSION_PROGRAM_H_

#include <vector>

namespace lacuna {

// The operations of a formula. kPower computes both x^y and pow(x, y).
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

// The number of values that the stack can hold. The parser rejects formulas that need more.
inline constexpr int kMaxStackDepth = 64;

// The number of values that the operation takes from the stack: 0, 1 or 2.
int Arity(Operation operation);

// Returns the result of the instructions [begin, end), which must leave exactly one value on the
// stack. `Number` is double, Dual<1> or Dual<3>. Allocates no memory and may run in several threads
// at the same time. Returns NaN or infinity where the formula is undefined.
template <typename Number>
Number RunProgram(const Instruction* begin, const Instruction* end, const Number* variables);

}  // namespace lacuna

#endif  // LACUNA_CORE_EXPRESSION_PROGRAM_H_
