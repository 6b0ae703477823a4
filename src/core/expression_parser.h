// The parser that converts a formula to instructions. core/expression.h describes the grammar.
#ifndef LACUNA_CORE_EXPRESSION_PARSER_H_
#define LACUNA_CORE_EXPRESSION_PARSER_H_

#include <string>
#include <vector>

#include "core/expression_program.h"

namespace lacuna {

struct ParsedExpression {
  ExpressionProgram program;
  std::vector<bool> uses;  // for each variable, whether the formula contains it
};

// Parses `text` with the variables `names`. Constant subexpressions are evaluated at once. Throws
// ExpressionError (core/expression_error.h) for a formula that is not well formed, contains an
// unknown name, is nested too deeply, or has a constant part that is not finite.
ParsedExpression ParseExpression(const std::string& text, const std::vector<std::string>& names);

// The names of all functions and constants, which a variable must not have.
const std::vector<std::string>& ReservedExpressionNames();

// Whether `text` is a letter or underscore followed by letters, digits and underscores.
bool IsExpressionName(const std::string& text);

}  // namespace lacuna

#endif  // LACUNA_CORE_EXPRESSION_PARSER_H_
