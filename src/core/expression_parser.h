// The parser of formulas: text in, instructions out. core/expression.h describes the grammar.
#ifndef LACUNA_CORE_EXPRESSION_PARSER_H_
#define LACUNA_CORE_EXPRESSION_PARSER_H_

#include <string>
#include <vector>

#include "core/expression_program.h"

namespace lacuna {

struct ParsedExpression {
  ExpressionProgram program;
  std::vector<bool> uses;  // for each variable, whether the formula mentions it
};

// Parses `text`, in which `names` are the variables. Subexpressions of constants are evaluated.
// Throws ExpressionError (core/expression_error.h) for a formula that is not well formed, names
// something unknown, is nested too deeply, or has a constant part that is not finite.
ParsedExpression ParseExpression(const std::string& text, const std::vector<std::string>& names);

// The names of all functions and constants, which a variable must not have.
const std::vector<std::string>& ReservedExpressionNames();

// Whether `text` is a letter or underscore followed by letters, digits and underscores.
bool IsExpressionName(const std::string& text);

}  // namespace lacuna

#endif  // LACUNA_CORE_EXPRESSION_PARSER_H_
