#include "core/expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string_view>

#include "core/suggestion.h"

namespace lacuna {
namespace {

bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool IsLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
// Of a character of several bytes in UTF-8, all but the first.
bool ContinuesCharacter(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

// The stack of a calculation: values with their derivatives in N directions. The two lie apart,
// each read and written in the same pieces: a processor waits for a wide read of what was written
// in parts.
template <int N, int kMaxDepth>
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

  // Replaces the last by a function of it; the slope is computed only where it is needed.
  template <typename Slope>
  void Replace(double value, const Slope& slope) {
    if constexpr (N > 0) {
      const double by_last = slope();
      double* last = derivative_[size_ - 1];
      for (int k = 0; k < N; ++k) last[k] = Times(by_last, last[k]);
    }
    value_[size_ - 1] = value;
  }
  // Replaces the last two by a function of both.
  template <typename SlopeX, typename SlopeY>
  void ReplaceTwo(double value, const SlopeX& slope_x, const SlopeY& slope_y) {
    if constexpr (N > 0) {
      const double by_x = slope_x(), by_y = slope_y();
      double* x = derivative_[size_ - 2];
      const double* y = derivative_[size_ - 1];
      for (int k = 0; k < N; ++k) x[k] = Times(by_x, x[k]) + Times(by_y, y[k]);
    }
    --size_;
    value_[size_ - 1] = value;
  }

 private:
  // What does not change stays so however steep the slope.
  static double Times(double slope, double change) {
    return slope == 0 || change == 0 ? 0 : slope * change;
  }

  int size_ = 0;
  double value_[kMaxDepth];
  double derivative_[kMaxDepth][N > 0 ? N : 1];
};

template <typename Number>
constexpr int kDirections = 0;
template <int N>
constexpr int kDirections<Dual<N>> = N;

}  // namespace

const std::vector<Expression::Function>& Expression::Functions() {
  static const std::vector<Function> functions{
      {"sin", Operation::kSin, 1},
      {"cos", Operation::kCos, 1},
      {"tan", Operation::kTan, 1},
      {"asin", Operation::kAsin, 1},
      {"acos", Operation::kAcos, 1},
      {"atan", Operation::kAtan, 1},
      {"atan2", Operation::kAtan2, 2},
      {"exp", Operation::kExp, 1},
      {"log", Operation::kLog, 1},
      {"sqrt", Operation::kSqrt, 1},
      {"abs", Operation::kAbs, 1},
      {"tanh", Operation::kTanh, 1},
      {"min", Operation::kMin, 2},
      {"max", Operation::kMax, 2},
      {"pow", Operation::kPower, 2},
      {"step", Operation::kStep, 1},
      {"smooth_step", Operation::kSmoothStep, 1},
  };
  return functions;
}

const std::vector<std::string>& Expression::ReservedNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{"pi"};
    for (const Function& function : Functions()) all.emplace_back(function.name);
    return all;
  }();
  return names;
}

int Expression::Arity(Operation operation) {
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

// Recursive descent; each rule leaves the instructions for its value.
class Expression::Parser {
 public:
  Parser(const std::vector<std::string>& names, Expression* expression)
      : text_(expression->text_), names_(names), expression_(*expression) {}

  void Parse() {
    SkipSpace();
    if (AtEnd()) Fail(0, "is empty");
    Sum();
    if (!AtEnd()) FailAtRest();
  }

 private:
  void Sum() {
    const size_t start = at_;
    Product();
    while (true) {
      if (Take('+')) {
        Product();
        Emit(start, Operation::kAdd);
      } else if (Take('-')) {
        Product();
        Emit(start, Operation::kSubtract);
      } else {
        return;
      }
    }
  }

  void Product() {
    const size_t start = at_;
    Signed();
    while (true) {
      const size_t at = at_;
      if (Take('*')) {
        if (!AtEnd() && text_[at_] == '*' && at_ == at + 1)
          Fail(at, "a power is written with \"^\", as in x^2");
        Signed();
        Emit(start, Operation::kMultiply);
      } else if (Take('/')) {
        Signed();
        Emit(start, Operation::kDivide);
      } else {
        return;
      }
    }
  }

  // Everything nested passes through here.
  void Signed() {
    const size_t start = at_;
    if (++nesting_ > kMaxNesting) Fail(start, "is nested too deeply");
    if (Take('-')) {
      Signed();
      Emit(start, Operation::kNegate);
    } else if (Take('+')) {
      Signed();
    } else {
      Primary();
      if (Take('^')) {
        Signed();
        Emit(start, Operation::kPower);
      }
    }
    --nesting_;
  }

  void Primary() {
    const size_t start = at_;
    if (AtEnd()) Fail(start, "ends where a value was expected");
    const char c = text_[at_];
    if (Take('(')) {
      Sum();
      Close(start);
    } else if (IsDigit(c) || c == '.') {
      Number();
    } else if (IsLetter(c)) {
      Name();
    } else {
      Fail(start, fmt::format("expected a value, got \"{}\"", CharacterAt(start)));
    }
  }

  void Number() {
    const size_t start = at_;
    double value = 0;
    const char* end_of_text = text_.data() + text_.size();
    const auto [end, error] = std::from_chars(text_.data() + start, end_of_text, value);
    if (error == std::errc::invalid_argument) Fail(start, "a \".\" without digits");
    if (error == std::errc::result_out_of_range) Fail(start, "a number out of range");
    at_ = static_cast<size_t>(end - text_.data());
    SkipSpace();
    Emit(start, Operation::kConstant, 0, value);
  }

  void Name() {
    const size_t start = at_;
    while (!AtEnd() && (IsLetter(text_[at_]) || IsDigit(text_[at_]))) ++at_;
    const std::string name = text_.substr(start, at_ - start);
    SkipSpace();
    const bool called = !AtEnd() && text_[at_] == '(';
    const auto function = std::find_if(Functions().begin(), Functions().end(),
                                       [&](const Function& each) { return each.name == name; });
    if (function != Functions().end()) {
      if (!called) {
        Fail(start, fmt::format("{} is a function, written {}({})", name, name,
                                function->arguments == 1 ? "..." : "..., ..."));
      }
      Call(*function, start);
      return;
    }
    const auto variable = std::find(names_.begin(), names_.end(), name);
    if (variable == names_.end() && name != "pi") {
      std::vector<std::string> known = called ? std::vector<std::string>() : names_;
      known.insert(known.end(), ReservedNames().begin(), ReservedNames().end());
      Fail(start, fmt::format("unknown {} \"{}\"{}", called ? "function" : "name", name,
                              Suggestion(name, known)));
    }
    if (called) Fail(at_, fmt::format("{} is no function; a product needs a \"*\"", name));
    if (name == "pi") {
      Emit(start, Operation::kConstant, 0, std::numbers::pi);
    } else {
      const auto number = static_cast<int>(variable - names_.begin());
      expression_.uses_[number] = true;
      Emit(start, Operation::kVariable, number);
    }
  }

  void Call(const Function& function, size_t start) {
    const size_t open = at_;
    Take('(');
    int given = 0;
    if (AtEnd() || text_[at_] != ')') {
      do {
        Sum();
        ++given;
      } while (Take(','));
    }
    Close(open);
    if (given != function.arguments) {
      Fail(start, fmt::format("{} takes {} argument{}, got {}", function.name, function.arguments,
                              function.arguments == 1 ? "" : "s", given));
    }
    Emit(start, function.operation);
  }

  void Close(size_t open) {
    if (Take(')')) return;
    if (AtEnd()) Fail(at_, fmt::format("no \")\" for the \"(\" in column {}", Column(open)));
    FailAtRest();
  }

  // `start`: where the part that the operation completes begins.
  void Emit(size_t start, Operation operation, int variable = 0, double constant = 0) {
    auto& program = expression_.program_;
    const int arity = Arity(operation);
    program.push_back({operation, variable, constant});
    depth_ += 1 - arity;
    if (depth_ > kMaxDepth) Fail(start, "is nested too deeply");
    // What has only constants is computed here and now.
    const auto first = program.end() - 1 - arity;
    if (arity == 0 || !std::all_of(first, program.end() - 1, [](const Instruction& each) {
          return each.operation == Operation::kConstant;
        })) {
      return;
    }
    const double value = Run<double>(program.data() + (first - program.begin()),
                                     program.data() + program.size(), nullptr);
    if (!std::isfinite(value)) Fail(start, "what starts here is not a finite number");
    program.resize(program.size() - arity);
    program.back() = {Operation::kConstant, 0, value};
  }

  bool AtEnd() const { return at_ >= text_.size(); }
  void SkipSpace() {
    while (!AtEnd() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n')) ++at_;
  }
  bool Take(char c) {
    if (AtEnd() || text_[at_] != c) return false;
    ++at_;
    SkipSpace();
    return true;
  }

  int Column(size_t at) const {
    return 1 + static_cast<int>(std::count_if(text_.begin(),
                                              text_.begin() + static_cast<std::ptrdiff_t>(at),
                                              [](char c) { return !ContinuesCharacter(c); }));
  }
  std::string_view CharacterAt(size_t at) const {
    size_t end = at + 1;
    while (end < text_.size() && ContinuesCharacter(text_[end])) ++end;
    return std::string_view(text_).substr(at, end - at);
  }

  [[noreturn]] void Fail(size_t at, const std::string& message) const {
    throw ExpressionError(Column(at), message);
  }

  // A value has been read, and what follows continues nothing.
  [[noreturn]] void FailAtRest() const {
    const char c = text_[at_];
    if (IsLetter(c) || IsDigit(c) || c == '.' || c == '(')
      Fail(at_, fmt::format("expected an operator before \"{}\"", c));
    if (c == '<' || c == '>' || c == '=')
      Fail(at_, fmt::format("\"{}\" is not known; a condition is written with step(...)", c));
    if (c == ',') Fail(at_, "a \",\" outside the arguments of a function");
    Fail(at_, fmt::format("unexpected \"{}\"", CharacterAt(at_)));
  }

  static constexpr int kMaxNesting = 200;

  const std::string& text_;
  const std::vector<std::string>& names_;
  Expression& expression_;
  size_t at_ = 0;
  int nesting_ = 0;
  int depth_ = 0;  // values on the stack
};

Expression::Expression(const std::string& text, const std::vector<std::string>& names)
    : text_(text), uses_(names.size(), false) {
  Parser(names, this).Parse();
}

bool Expression::IsName(const std::string& text) {
  return !text.empty() && IsLetter(text[0]) &&
         std::all_of(text.begin(), text.end(), [](char c) { return IsLetter(c) || IsDigit(c); });
}

template <typename Number>
Number Expression::Run(const Instruction* begin, const Instruction* end, const Number* variables) {
  constexpr int N = kDirections<Number>;
  Stack<N, kMaxDepth> stack;
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

template <typename Stack>
void Expression::ApplyToOne(Operation operation, Stack* stack) {
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
void Expression::ApplyToTwo(Operation operation, Stack* stack) {
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
    // Not std::min and std::max, which may lose a NaN.
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
        // The logarithm of a negative base is of no concern to a constant exponent.
        const bool flat = !stack->LastVaries() || (x == 0 && y > 0);
        return flat ? 0 : value * std::log(x);
      };
      return stack->ReplaceTwo(value, by_base, by_exponent);
    }
    default:
      return;
  }
}

template <typename Number>
Number Expression::At(const Number* variables) const {
  return Run(program_.data(), program_.data() + program_.size(), variables);
}

template double Expression::At(const double*) const;
template Dual<1> Expression::At(const Dual<1>*) const;
template Dual<3> Expression::At(const Dual<3>*) const;

}  // namespace lacuna
