// The exception for a formula that cannot be parsed.
#ifndef LACUNA_CORE_EXPRESSION_ERROR_H_
#define LACUNA_CORE_EXPRESSION_ERROR_H_

#include <stdexcept>
#include <string>

namespace lacuna {

// Thrown for a formula that cannot be parsed. what() has the form "column 9: unknown name …"; the
// caller adds the file and the field. Columns are counted in UTF-8 characters from 1.
class ExpressionError : public std::invalid_argument {
 public:
  ExpressionError(int column, const std::string& message)
      : std::invalid_argument("column " + std::to_string(column) + ": " + message),
        column_(column) {}
  int column() const { return column_; }

 private:
  int column_;
};

}  // namespace lacuna

#endif  // LACUNA_CORE_EXPRESSION_ERROR_H_
