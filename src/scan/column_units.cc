#include "scan/column_units.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string_view>

#include "core/error.h"
#include "scan/column_name.h"
#include "scan/delimited_table.h"
#include "scan/table_text.h"

namespace lacuna {
namespace {

// The text at the end of a column's name that is a unit of this dimension, in any case, behind a
// character that is neither a letter nor a digit, the longest first.
std::string UnitBehindName(const std::string& name, const Dimension& dimension) {
  for (size_t at = name.find_first_of(" _/<,;:"); at != std::string::npos;
       at = name.find_first_of(" _/<,;:", at + 1)) {
    std::string rest(Trim(std::string_view(name).substr(at + 1)));
    if (rest.ends_with('>')) rest.pop_back();
    const std::optional<MeasuredQuantity> unit = ParsedUnit(rest);
    if (unit ? unit->dimension.SameAs(dimension) : !UnitsInAnyCase(rest, dimension).empty())
      return rest;
  }
  return "";
}

// Whether a text in brackets behind the name of a column is none of the units that are known, nor
// one in another case, nor a voltage.
bool IsRemark(const std::string& text, const Dimension& dimension) {
  if (text == "V" || text == "mV") return false;
  if (!ParsedUnit(text)) return UnitsInAnyCase(text, dimension).empty();
  const bool is_number = text.find_first_not_of("0123456789") == std::string::npos;
  const bool is_minimum = text == "min" && !dimension.SameAs(kTime);
  return is_number || is_minimum;
}

}  // namespace

std::string UnitOfColumn(const DelimitedTable& table, Eigen::Index column) {
  const size_t k = static_cast<size_t>(column);
  if (k < table.units.size() && !table.units[k].empty()) return table.units[k];
  return SplitColumnName(table.header[k]).unit;
}

std::string LengthUnitOfColumn(const DelimitedTable& table, Eigen::Index column) {
  const std::string own = UnitOfColumn(table, column);
  const std::optional<MeasuredQuantity> unit = ParsedUnit(own);
  return unit && unit->dimension.SameAs(kLength) ? own : "";
}

void RefuseOtherUnit(const DelimitedTable& table, Eigen::Index column, double unit,
                     const Dimension& dimension, const std::string& key) {
  if (table.header.empty()) return;
  const std::string& header = table.header[static_cast<size_t>(column)];
  std::string own = UnitOfColumn(table, column);
  if (own.starts_with("in ")) own.erase(0, 3);
  if (own.empty()) own = UnitBehindName(header, dimension);
  if (own.empty() || IsRemark(own, dimension)) return;
  constexpr double kRounding = 1e-9;
  const std::vector<std::string> meant =
      ParsedUnit(own) ? std::vector<std::string>{own} : UnitsInAnyCase(own, dimension);
  std::string other;  // of the same dimension
  for (const std::string& symbol : meant) {
    const MeasuredQuantity named = ParsedUnit(symbol).value();
    if (!named.dimension.SameAs(dimension)) continue;
    if (std::abs(named.value - unit) <= kRounding * unit) return;
    if (other.empty()) other = symbol;
  }
  if (other.empty())
    throw InputError(
        {table.file.string()},
        fmt::format("has a column \"{}\" in \"{}\", which is not a unit of {}; name another "
                    "column, or rename this one and convert its values",
                    header, own, dimension.name));
  throw InputError({table.file.string()},
                   fmt::format("has a column \"{}\", but its values are read in another unit; say "
                               "`{}: {}` in recording.yaml, or rename the column",
                               header, key, other));
}

void RefuseOtherUnits(const DelimitedTable& table, const std::vector<std::string>& names,
                      double unit, const Dimension& dimension, const std::string& key) {
  if (table.header.empty()) return;
  for (const std::string& name : names)
    RefuseOtherUnit(table, RequireColumn(table, name), unit, dimension, key);
}

}  // namespace lacuna
