#include "standard/published_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/error.h"
#include "scan/table_numbers.h"
#include "scan/table_text.h"

namespace lacuna {

PublishedTable PublishedTable::Load(const std::filesystem::path& file) {
  PublishedTable table{file, {}, {}};
  const std::string content = ReadFilledText(file);
  for (const std::string_view line : SplitLines(content)) {
    if (Trim(line).empty()) continue;
    const std::vector<std::string_view> fields = SplitFields(line, ',');
    std::vector<std::string> row(fields.begin(), fields.end());
    if (table.header.empty())
      table.header = std::move(row);
    else
      table.rows.push_back(std::move(row));
  }
  return table;
}

double PublishedTable::Number(int row, const std::string& column) const {
  const auto found = std::find(header.begin(), header.end(), column);
  if (found == header.end())
    throw InputError(fmt::format("{}: has no column \"{}\"", file.string(), column));
  const auto k = static_cast<size_t>(found - header.begin());
  if (row < 1 || row > static_cast<int>(rows.size()) ||
      k >= rows[static_cast<size_t>(row - 1)].size())
    throw InputError(fmt::format("{}: has no entry {} in row {}", file.string(), column, row));
  const std::string& text = rows[static_cast<size_t>(row - 1)][k];
  const std::optional<double> number = ParseNumber(text);
  if (!number)
    throw InputError(
        fmt::format("{}: row {}, {}: \"{}\" is not a number", file.string(), row, column, text));
  return *number;
}

}  // namespace lacuna
