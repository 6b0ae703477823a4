// Columns of a table by their names.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/error.h"
#include "core/parsed_word.h"
#include "scan/delimited_table.h"
#include "scan/table_text.h"

namespace lacuna {
namespace {

// The columns of this name, with regard to the case of its letters or without.
std::vector<Eigen::Index> ColumnsNamed(const DelimitedTable& table, const std::string& name,
                                       bool case_counts) {
  const auto is_same = [case_counts](char a, char b) { return IsSameLetter(a, b, case_counts); };
  std::vector<Eigen::Index> columns;
  for (size_t column = 0; column < table.header.size(); ++column) {
    const std::string& other = table.header[column];
    if (std::equal(name.begin(), name.end(), other.begin(), other.end(), is_same))
      columns.push_back(static_cast<Eigen::Index>(column));
  }
  return columns;
}

// The only one of `columns`, nothing where there is none.
std::optional<Eigen::Index> OnlyColumn(const DelimitedTable& table, const std::string& name,
                                       const std::vector<Eigen::Index>& columns) {
  if (columns.empty()) return std::nullopt;
  if (columns.size() > 1)
    throw InputError(
        {table.file.string()},
        fmt::format("has {} columns \"{}\", of which the numbers are {} and {}; rename "
                    "one of them, or give the number of the one that is meant",
                    columns.size(), name, columns[0] + 1, columns[1] + 1));
  return columns.front();
}

}  // namespace

std::optional<Eigen::Index> FindColumn(const DelimitedTable& table, const std::string& name) {
  const std::vector<Eigen::Index> same = ColumnsNamed(table, name, /*case_counts=*/true);
  if (!same.empty()) return OnlyColumn(table, name, same);
  const auto number = ParseWord<int>(name);
  if (number && *number >= 1 && *number <= table.values.cols()) return *number - 1;
  return OnlyColumn(table, name, ColumnsNamed(table, name, /*case_counts=*/false));
}

Eigen::Index RequireColumn(const DelimitedTable& table, const std::string& name) {
  if (const std::optional<Eigen::Index> column = FindColumn(table, name)) return *column;
  const std::string there =
      table.header.empty() ? fmt::format("it has no header and {} columns", table.values.cols())
                           : fmt::format("its columns are {}", fmt::join(table.header, ", "));
  throw InputError({table.file.string()}, fmt::format("has no column \"{}\"; {}", name, there));
}

}  // namespace lacuna
