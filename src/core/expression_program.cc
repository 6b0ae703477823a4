#include "core/expression_program.h"

#include <algorithm>
#include <cmath>

#include "core/dual.h"

namespace lacuna {
namespace {

// A program takes no more from the stack than it has put there, and names no variable that is absent:
// the parser sees to it, and the static analyzer cannot know. NOLINTBEGIN(clang-analyzer-core.*)

// The stack of an evaluation: values with their derivatives in N directions. Values and derivatives
// are stored separately, so that each location is always read and written with the same width. A
// wide load directly after several narrow stores to the same location would stall the processor.
template <int N>
class Stack {
 public:
  void Push(double value) {
    value_[size_] = value;
    for (int k = 0; k < N; ++k) derivative_[size_][k] = 0;
    ++size_;
  }
  void Push(const Dual<N>& number) {
    value_[size_] = number.value;
    for (int k = 0; k < N; ++k) derivative_[size_][k] = number.derivative[k];
    ++size_;
  }

  double Last() const { return value_[size_ - 1]; }
  double BeforeLast() const { return value_[size_ - 2]; }
  bool LastVaries() const {
    for (int k = 0; k < N; ++k)
      if (derivative_[size_ - 1][k] != 0) return true;
    return false;
  }
  double Derivative(int direction) const { return derivative_[size_ - 1][direction]; }

  // Replaces the topmost value by a function of it. `slope` computes the derivative of that
  // function and is called only if derivatives are wanted.
  template <typename Slope>
  void Replace(double value, const Slope& slope) {
    if constexpr (N > 0) {
      const double slope_last = slope();
      double* last = derivative_[size_ - 1];
      for (int k = 0; k < N; ++k) last[k] = Times(slope_last, last[k]);
    }
    value_[size_ - 1] = value;
  }
  // Replaces the two topmost values by a function of both.
  template <typename SlopeX, typename SlopeY>
  void ReplaceTwo(double value, const SlopeX& slope_x, const SlopeY& slope_y) {
    if constexpr (N > 0) {
      const double x_slope = slope_x(), y_slope = slope_y();
      double* x = derivative_[size_ - 2];
      const double* y = derivative_[size_ - 1];
      for (int k = 0; k < N; ++k) x[k] = Times(x_slope, x[k]) + Times(y_slope, y[k]);
    }
    --size_;
    value_[size_ - 1] = value;
  }

 private:
  // An argument whose derivative is 0 contributes 0 even where the slope is infinite, as for sqrt
  // at 0.
  static double Times(double slope, double change) {
    return slope == 0 || change == 0 ? 0 : slope * change;
  }

  int size_ = 0;
  double value_[kMaxStackDepth];
  double derivative_[kMaxStackDepth][std::max(N, 1)];
};

template <typename Number>
constexpr int kDirections = 0;
template <int N>
constexpr int kDirections<Dual<N>> = N;

template <typename Stack>
void ApplyToOne(Operation operation, Stack* stack) {
  const double x = stack->Last();
  switch (operation) {
    case Operation::kNegate:
      return stack->Replace(-x, [] { return -1.0; });
    case Operation::kSin:
      return stack->Replace(std::sin(x), [x] { return std::cos(x); });
    case Operation::kCos:
      return stack->Replace(std::cos(x), [x] { return -std::sin(x); });
    case Operation::kTan: {
      const double value = std::tan(x);
      return stack->Replace(value, [value] { return 1 + value * value; });
    }
    case Operation::kAsin:
      return stack->Replace(std::asin(x), [x] { return 1 / std::sqrt(1 - x * x); });
    case Operation::kAcos:
      return stack->Replace(std::acos(x), [x] { return -1 / std::sqrt(1 - x * x); });
    case Operation::kAtan:
      return stack->Replace(std::atan(x), [x] { return 1 / (1 + x * x); });
    case Operation::kExp: {
      const double value = std::exp(x);
      return stack->Replace(value, [value] { return value; });
    }
    case Operation::kLog:
      return stack->Replace(std::log(x), [x] { return 1 / x; });
    case Operation::kSqrt: {
      const double value = std::sqrt(x);
      return stack->Replace(value, [value] { return 0.5 / value; });
    }
    case Operation::kAbs:
      return stack->Replace(std::abs(x), [x] { return x > 0 ? 1.0 : x < 0 ? -1.0 : 0.0; });
    case Operation::kTanh: {
      const double value = std::tanh(x);
      return stack->Replace(value, [value] { return 1 - value * value; });
    }
    case Operation::kStep:
      return stack->Replace(std::isnan(x) ? x : (x >= 0 ? 1.0 : 0.0), [] { return 0.0; });
    case Operation::kSmoothStep: {
      const double s = std::isnan(x) ? x : std::clamp(x, 0.0, 1.0);
      return stack->Replace(s * s * (3 - 2 * s), [s] { return 6 * s * (1 - s); });
    }
    default:
      return;
  }
}

template <typename Stack>
void ApplyToTwo(Operation operation, Stack* stack) {
  const double x = stack->BeforeLast(), y = stack->Last();
  const auto replace = [stack](double value, double slope_x, double slope_y) {
    stack->ReplaceTwo(
        value, [slope_x] { return slope_x; }, [slope_y] { return slope_y; });
  };
  switch (operation) {
    case Operation::kAdd:
      return replace(x + y, 1, 1);
    case Operation::kSubtract:
      return replace(x - y, 1, -1);
    case Operation::kMultiply:
      return replace(x * y, y, x);
    case Operation::kDivide:
      return replace(x / y, 1 / y, -x / (y * y));
    case Operation::kAtan2: {
      const double square = x * x + y * y;
      return replace(std::atan2(x, y), y / square, -x / square);
    }
    // std::min and std::max are not used, because they can discard a NaN.
    case Operation::kMin:
      return y < x || std::isnan(y) ? replace(y, 0, 1) : replace(x, 1, 0);
    case Operation::kMax:
      return y > x || std::isnan(y) ? replace(y, 0, 1) : replace(x, 1, 0);
    case Operation::kPower: {
      const double value = y == 2 ? x * x : std::pow(x, y);
      const auto by_base = [x, y] {
        if (y == 2) return 2 * x;
        return y == 0 ? 0 : y * std::pow(x, y - 1);
      };
      const auto by_exponent = [x, y, value, stack] {
        // For a constant exponent this derivative is not needed, and the logarithm of a negative
        // base would be NaN.
        const bool flat = !stack->LastVaries() || (x == 0 && y > 0);
        return flat ? 0 : value * std::log(x);
      };
      return stack->ReplaceTwo(value, by_base, by_exponent);
    }
    default:
      return;
  }
}

}  // namespace

int Arity(Operation operation) {
  switch (operation) {
    case Operation::kConstant:
    case Operation::kVariable:
      return 0;
    case Operation::kAdd:
    case Operation::kSubtract:
    case Operation::kMultiply:
    case Operation::kDivide:
    case Operation::kPower:
    case Operation::kAtan2:
    case Operation::kMin:
    case Operation::kMax:
      return 2;
    default:
      return 1;
  }
}

template <typename Number>
Number RunProgram(const Instruction* begin, const Instruction* end, const Number* variables) {
  constexpr int N = kDirections<Number>;
  Stack<N> stack;
  for (const Instruction* instruction = begin; instruction != end; ++instruction) {
    switch (instruction->operation) {
      case Operation::kConstant:
        stack.Push(instruction->constant);
        break;
      case Operation::kVariable:
        stack.Push(variables[instruction->variable]);
        break;
      default:
        if (Arity(instruction->operation) == 1) {
          ApplyToOne(instruction->operation, &stack);
        } else {
          ApplyToTwo(instruction->operation, &stack);
        }
    }
  }
  if constexpr (N == 0) {
    return stack.Last();
  } else {
    Number result = Number::Constant(stack.Last());
    for (int k = 0; k < N; ++k) result.derivative[k] = stack.Derivative(k);
    return result;
  }
}

// NOLINTEND(clang-analyzer-core.*)

template double RunProgram(const Instruction*, const Instruction*, const double*);
template Dual<1> RunProgram(const Instruction*, const Instruction*, const Dual<1>*);
template Dual<3> RunProgram(const Instruction*, const Instruction*, const Dual<3>*);

}  // namespace lacuna
