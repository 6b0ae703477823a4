#include "scan/marker_place_table.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "core/error.h"
#include "scan/delimited_table.h"
#include "scan/table_layout.h"
#include "scan/table_numbers.h"
#include "scan/table_text.h"

namespace lacuna {
namespace {

using Fields = std::vector<std::string_view>;

constexpr std::array<const char*, 4> kColumns = {"name", "x", "y", "z"};

// The positions of kColumns in the line of names.
std::array<size_t, 4> FindColumns(const Fields& names, const std::filesystem::path& file,
                                  int line) {
  DelimitedTable table;
  table.file = file;
  table.header.assign(names.begin(), names.end());
  std::array<size_t, 4> columns{};
  for (size_t k = 0; k < kColumns.size(); ++k) {
    const std::optional<Eigen::Index> found = FindColumn(table, kColumns[k]);
    if (!found)
      throw InputError({file.string(), line, 1},
                       fmt::format("has no column \"{}\"; the first line must name the columns: "
                                   "name, x, y and z",
                                   kColumns[k]));
    columns[k] = static_cast<size_t>(*found);
  }
  return columns;
}

// One row of a table.
struct Row {
  std::string_view line;
  Fields fields;
  int number = 0;  // of the line, from 1

  // Where an entry is in the file.
  int ColumnOf(std::string_view entry) const {
    return static_cast<int>(entry.data() - line.data()) + 1;
  }
};

// The rows that are neither empty nor comments, the names of the columns first, and the delimiter.
std::vector<Row> ReadRows(std::string_view content, char* delimiter) {
  std::vector<Row> rows;
  int number = 0;
  *delimiter = 0;
  for (const std::string_view line : SplitLines(content)) {
    ++number;
    const std::string_view text = Trim(line);
    if (text.empty() || text.front() == '#') continue;
    if (const auto declared = DeclaredDelimiter(line); declared && number == 1) {
      *delimiter = *declared;
      continue;
    }
    if (*delimiter == 0) {
      const auto end = static_cast<size_t>(line.data() + line.size() - content.data());
      *delimiter = FindDelimiter(text, content.substr(end));
    }
    Row row{line, SplitFields(line, *delimiter), number};
    if (!AreEmpty(row.fields)) rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

std::vector<MarkerPlace> ReadMarkerPlaces(const std::filesystem::path& file) {
  const std::string content = ReadFilledText(file);
  char delimiter = 0;
  const std::vector<Row> rows = ReadRows(content, &delimiter);
  if (rows.size() < 2) throw InputError({file.string()}, "has no row with the place of a marker");
  const std::array<size_t, 4> columns = FindColumns(rows.front().fields, file, rows.front().number);
  std::vector<MarkerPlace> places;
  DecimalCommas commas;
  for (auto row = rows.begin() + 1; row != rows.end(); ++row) {
    if (row->fields.size() != rows.front().fields.size())
      throw InputError({file.string(), row->number, 1},
                       fmt::format("has {} entries where the first line has {}", row->fields.size(),
                                   rows.front().fields.size()));
    MarkerPlace place{std::string(row->fields[columns[0]]), Eigen::Vector3d(), row->number};
    for (size_t axis = 0; axis < 3; ++axis) {
      const std::string_view entry = row->fields[columns[axis + 1]];
      const std::optional<double> value = ParseDecimal(entry);
      if (!value)
        throw InputError({file.string(), row->number, row->ColumnOf(entry)},
                         fmt::format("got \"{}\"; expected a number", entry));
      commas.Add(entry, row->number, row->ColumnOf(entry));
      place.position[static_cast<Eigen::Index>(axis)] = *value;
    }
    places.push_back(std::move(place));
  }
  commas.RefuseThousands(file, delimiter);
  return places;
}

}  // namespace lacuna
