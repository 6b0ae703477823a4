#include "scan/delimited_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/text_file.h"

namespace lacuna {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

std::string_view Trim(std::string_view text) {
  const size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return text.substr(0, 0);
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::string_view Unquote(std::string_view text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    return Trim(text.substr(1, text.size() - 2));
  }
  return text;
}

char FindDelimiter(std::string_view line) {
  for (const char candidate : {';', ',', '\t'}) {
    if (line.find(candidate) != std::string_view::npos) return candidate;
  }
  return ' ';
}

bool LooksLikeHeader(const std::vector<std::string_view>& fields) {
  for (const std::string_view field : fields) {
    if (!ParseNumber(field)) return true;
  }
  return false;
}

}  // namespace

std::vector<std::string_view> SplitFields(std::string_view line, char delimiter) {
  std::vector<std::string_view> fields;
  if (delimiter == ' ') {
    size_t at = line.find_first_not_of(kBlanks);
    while (at != std::string_view::npos) {
      const size_t end = line.find_first_of(kBlanks, at);
      fields.push_back(line.substr(at, end == std::string_view::npos ? end : end - at));
      at = line.find_first_not_of(kBlanks, end);
    }
    return fields;
  }
  size_t at = 0;
  while (true) {
    const size_t end = line.find(delimiter, at);
    fields.push_back(
        Unquote(Trim(line.substr(at, end == std::string_view::npos ? end : end - at))));
    if (end == std::string_view::npos) return fields;
    at = end + 1;
  }
}

std::optional<double> ParseNumber(std::string_view text) {
  if (text.empty()) return std::numeric_limits<double>::quiet_NaN();
  if (text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string ReadFilledFile(const std::filesystem::path& file) {
  std::string content = ReadWholeFile(file);
  if (content.empty()) throw InputError({file.string()}, "is empty");
  return content;
}

DelimitedTable ReadDelimitedTable(const std::filesystem::path& file) {
  const std::string content = ReadFilledFile(file);
  DelimitedTable table;
  table.file = file;
  std::vector<double> entries;
  size_t width = 0;
  char delimiter = 0;
  int line_number = 0;
  for (size_t at = 0; at < content.size();) {
    const size_t end = std::min(content.find('\n', at), content.size());
    const std::string_view line(content.data() + at, end - at);
    at = end + 1;
    ++line_number;
    if (Trim(line).empty() || Trim(line).front() == '#') continue;
    if (delimiter == 0) delimiter = FindDelimiter(Trim(line));
    const std::vector<std::string_view> fields = SplitFields(line, delimiter);
    if (width == 0) {
      width = fields.size();
      if (LooksLikeHeader(fields)) {
        table.header.assign(fields.begin(), fields.end());
        continue;
      }
    }
    if (fields.size() != width) {
      throw InputError(
          {file.string(), line_number, 1},
          fmt::format("has {} entries where the first line has {}", fields.size(), width));
    }
    for (const std::string_view field : fields) {
      const std::optional<double> value = ParseNumber(field);
      if (!value) {
        const int column = static_cast<int>(field.data() - line.data()) + 1;
        throw InputError({file.string(), line_number, column},
                         fmt::format("got \"{}\"; expected a number", field));
      }
      entries.push_back(*value);
    }
    table.line.push_back(line_number);
  }
  if (table.line.empty()) throw InputError({file.string()}, "holds no row of numbers");
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  table.values = Eigen::Map<const RowMajor>(entries.data(), table.line.size(), width);
  return table;
}

std::optional<Eigen::Index> FindColumn(const DelimitedTable& table, const std::string& name) {
  for (size_t column = 0; column < table.header.size(); ++column) {
    if (table.header[column] == name) return column;
  }
  int number = 0;
  const auto [end, problem] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (problem == std::errc() && end == name.data() + name.size() && number >= 1 &&
      number <= table.values.cols()) {
    return number - 1;
  }
  return std::nullopt;
}

Eigen::Index RequireColumn(const DelimitedTable& table, const std::string& name) {
  if (const std::optional<Eigen::Index> column = FindColumn(table, name)) return *column;
  const std::string there =
      table.header.empty() ? fmt::format("it has no header and {} columns", table.values.cols())
                           : fmt::format("its columns are {}", fmt::join(table.header, ", "));
  throw InputError({table.file.string()}, fmt::format("has no column \"{}\"; {}", name, there));
}

}  // namespace lacuna
