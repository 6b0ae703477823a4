// The name of a column of a table of text, and the unit in it.
#ifndef LACUNA_SCAN_COLUMN_NAME_H_
#define LACUNA_SCAN_COLUMN_NAME_H_

#include <optional>
#include <string>
#include <string_view>

#include "core/quantity.h"

namespace lacuna {

// The quantity that one of this unit is, as ParseAnyQuantity() gives it; nothing where the unit is
// unknown or the text is empty.
std::optional<MeasuredQuantity> ParsedUnit(std::string_view unit);

// The name of a column, and the unit behind it in brackets or parentheses: "Force" and "kN" of
// "Force [kN]". The unit is empty where there is none.
struct ColumnName {
  std::string name, unit;
};
ColumnName SplitColumnName(const std::string& header);

}  // namespace lacuna

#endif  // LACUNA_SCAN_COLUMN_NAME_H_
