#include "core/expression.h"

#include <utility>

#include "core/expression_parser.h"

namespace lacuna {

Expression::Expression(const std::string& text, const std::vector<std::string>& names)
    : text_(text) {
  ParsedExpression parsed = ParseExpression(text, names);
  program_ = std::move(parsed.program);
  uses_ = std::move(parsed.uses);
}

const std::vector<std::string>& Expression::ReservedNames() { return ReservedExpressionNames(); }

bool Expression::IsName(const std::string& text) { return IsExpressionName(text); }

template <typename Number>
Number Expression::At(const Number* variables) const {
  return RunProgram(program_.data(), program_.data() + program_.size(), variables);
}

template double Expression::At(const double*) const;
template Dual<1> Expression::At(const Dual<1>*) const;
template Dual<3> Expression::At(const Dual<3>*) const;

}  // namespace lacuna
