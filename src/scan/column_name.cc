#include "scan/column_name.h"

#include <stdexcept>

namespace lacuna {

std::optional<MeasuredQuantity> ParsedUnit(std::string_view unit) {
  if (unit.empty()) return std::nullopt;
  try {
    return ParseAnyQuantity("1 " + std::string(unit));
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

ColumnName SplitColumnName(const std::string& header) {
  const size_t open = header.find_first_of("[(");
  if (open == std::string::npos) return {header, ""};
  const size_t end = header.find_last_not_of(' ', open == 0 ? 0 : open - 1);
  const size_t close = header.find_first_of("])", open);
  return {open == 0 ? "" : header.substr(0, end + 1),
          header.substr(open + 1, close == std::string::npos ? close : close - open - 1)};
}

}  // namespace lacuna
