#include "core/expression_parser.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "core/expression_error.h"
#include "core/suggestion.h"
#include "core/utf8.h"

namespace lacuna {
namespace {

bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool IsLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

struct Function {
  const char* name;
  Operation operation;
  int arguments;
};

const std::vector<Function>& Functions() {
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

// A recursive-descent parser. Each rule appends the instructions that compute its value.
class Parser {
 public:
  Parser(const std::string& text, const std::vector<std::string>& names)
      : text_(text), names_(names) {
    expression_.uses.assign(names.size(), false);
  }

  ParsedExpression Parse() {
    SkipSpace();
    if (AtEnd()) Fail(0, "the formula is empty");
    Sum();
    if (!AtEnd()) FailAtRest();
    return std::move(expression_);
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
          Fail(at, "write a power with \"^\", as in x^2");
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

  // Every nested expression is parsed by this rule, so it limits the depth of nesting.
  void Signed() {
    const size_t start = at_;
    if (++nesting_ > kMaxNesting) Fail(start, "the formula is nested too deeply");
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
    if (AtEnd()) Fail(start, "expected a value, but the formula ends");
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
    if (error == std::errc::invalid_argument)
      Fail(start, "expected digits before or after the \".\"");
    if (error == std::errc::result_out_of_range) Fail(start, "the number is out of range");
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
        Fail(start, fmt::format("{} is a function; write {}({})", name, name,
                                function->arguments == 1 ? "..." : "..., ..."));
      }
      Call(*function, start);
      return;
    }
    const auto variable = std::find(names_.begin(), names_.end(), name);
    if (variable == names_.end() && name != "pi") {
      std::vector<std::string> known = called ? std::vector<std::string>() : names_;
      known.insert(known.end(), ReservedExpressionNames().begin(), ReservedExpressionNames().end());
      Fail(start, fmt::format("unknown {} \"{}\"{}", called ? "function" : "name", name,
                              Suggestion(name, known)));
    }
    if (called) Fail(at_, fmt::format("{} is not a function; write a product with \"*\"", name));
    if (name == "pi") {
      Emit(start, Operation::kConstant, 0, std::numbers::pi);
    } else {
      const auto number = static_cast<int>(variable - names_.begin());
      expression_.uses[number] = true;
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
    if (AtEnd()) Fail(at_, fmt::format("missing \")\" for the \"(\" in column {}", Column(open)));
    FailAtRest();
  }

  // Appends an instruction. The subexpression that it completes begins at position `start`.
  void Emit(size_t start, Operation operation, int variable = 0, double constant = 0) {
    auto& program = expression_.program;
    const int arity = Arity(operation);
    program.push_back({operation, variable, constant});
    depth_ += 1 - arity;
    if (depth_ > kMaxStackDepth) Fail(start, "the formula is nested too deeply");
    // An operation whose arguments are all constant is evaluated at once.
    const auto first = program.end() - 1 - arity;
    if (arity == 0 || !std::all_of(first, program.end() - 1, [](const Instruction& each) {
          return each.operation == Operation::kConstant;
        })) {
      return;
    }
    const double value = RunProgram<double>(program.data() + (first - program.begin()),
                                            program.data() + program.size(), nullptr);
    if (!std::isfinite(value))
      Fail(start, "the value of the subexpression that starts here is not finite");
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

  // Throws the error for the text at the current position, which cannot follow the last value.
  [[noreturn]] void FailAtRest() const {
    const char c = text_[at_];
    if (IsLetter(c) || IsDigit(c) || c == '.' || c == '(')
      Fail(at_, fmt::format("expected an operator before \"{}\"", c));
    if (c == '<' || c == '>' || c == '=')
      Fail(at_, fmt::format("unknown operator \"{}\"; write a condition with step(...)", c));
    if (c == ',') {
      const bool is_decimal =
          at_ > 0 && IsDigit(text_[at_ - 1]) && at_ + 1 < text_.size() && IsDigit(text_[at_ + 1]);
      Fail(at_, std::string("unexpected \",\" outside the arguments of a function") +
                    (is_decimal ? "; the decimal separator must be a point" : ""));
    }
    Fail(at_, fmt::format("unexpected \"{}\"", CharacterAt(at_)));
  }

  static constexpr int kMaxNesting = 200;

  const std::string& text_;
  const std::vector<std::string>& names_;
  ParsedExpression expression_;
  size_t at_ = 0;
  int nesting_ = 0;
  int depth_ = 0;  // values on the stack at this point of the program
};

}  // namespace

ParsedExpression ParseExpression(const std::string& text, const std::vector<std::string>& names) {
  return Parser(text, names).Parse();
}

const std::vector<std::string>& ReservedExpressionNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{"pi"};
    for (const Function& function : Functions()) all.emplace_back(function.name);
    return all;
  }();
  return names;
}

bool IsExpressionName(const std::string& text) {
  return !text.empty() && IsLetter(text[0]) &&
         std::all_of(text.begin(), text.end(), [](char c) { return IsLetter(c) || IsDigit(c); });
}

}  // namespace lacuna
