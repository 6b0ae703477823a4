#include "scan/table_header.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>

#include "core/error.h"
#include "scan/delimited_table.h"
#include "scan/table_layout.h"
#include "scan/table_numbers.h"
#include "scan/table_text.h"

namespace lacuna {
namespace {

constexpr std::string_view kBlanks = " \t\r";

// What follows the mark of a comment; nothing if the line is none.
std::optional<std::string_view> CommentIn(std::string_view line) {
  line = Trim(line);
  if (line.empty()) return line;
  if (line.front() == '#') {
    line.remove_prefix(std::min(line.find_first_not_of('#'), line.size()));
    return Trim(line);
  }
  if (line.substr(0, 3) != "***") return std::nullopt;
  line.remove_prefix(std::min(line.find_first_not_of('*'), line.size()));
  return Trim(line);
}

// The position of a separator of name and value, which a blank or the end of the line follows: the
// colons of times of day separate nothing.
size_t FindSeparator(std::string_view line, size_t from) {
  for (size_t at = from; at < line.size(); ++at)
    if ((line[at] == ':' || line[at] == '=') &&
        (at + 1 == line.size() || kBlanks.find(line[at + 1]) != std::string_view::npos))
      return at;
  return std::string_view::npos;
}

// `has_decimal_commas`: of the rows below. Without them, the comma of "1,005" may as well separate
// thousands, and such a value is left out.
std::optional<HeaderValue> ParseValue(std::string_view text, bool has_decimal_commas) {
  const size_t end = std::min(text.find_first_of(" \t["), text.size());
  const std::optional<double> number = ParseDecimal(text.substr(0, end));
  if (MayBeThousands(text.substr(0, end)) && !has_decimal_commas) return std::nullopt;
  if (end == 0 || !number) return std::nullopt;
  std::string_view unit = Trim(text.substr(end));
  if (unit.size() >= 2 && unit.front() == '[' && unit.back() == ']')
    unit = Trim(unit.substr(1, unit.size() - 2));
  // Several words are a remark or a date.
  if (unit.find_first_of(kBlanks) != std::string_view::npos) return std::nullopt;
  if (!unit.empty() && ParseNumber(unit.substr(0, 1))) return std::nullopt;
  return HeaderValue{*number, std::string(unit)};
}

// Whether the numbers of the rows below the comments may have decimal commas: where ';' or a tab is
// between their columns, and no decimal point is in the first two rows, of which one may be that of
// the names.
bool MayHaveDecimalCommas(const std::vector<std::string_view>& lines) {
  int rows = 0;
  for (size_t row = 0; row < lines.size() && rows < 2; ++row) {
    if (CommentIn(lines[row]) || DeclaredDelimiter(lines[row])) continue;
    if (lines[row].find_first_of(";\t") == std::string_view::npos) return false;
    ++rows;
    for (const std::string_view field :
         SplitFields(lines[row], lines[row].find(';') == std::string_view::npos ? '\t' : ';'))
      if (ParseNumber(field) && field.find('.') != std::string_view::npos) return false;
  }
  return rows > 0;
}

}  // namespace

std::map<std::string, HeaderValue> HeaderValuesIn(std::string_view content) {
  std::map<std::string, HeaderValue> values;
  const std::vector<std::string_view> lines = SplitLines(content);
  const bool has_decimal_commas = MayHaveDecimalCommas(lines);
  for (size_t row = 0; row < lines.size(); ++row) {
    const std::optional<std::string_view> comment = CommentIn(lines[row]);
    if (!comment && Trim(lines[row]) == kStageHeader && row + 1 < lines.size()) {
      const auto names = SplitFields(lines[row], ';'), fields = SplitFields(lines[++row], ';');
      for (size_t k = 0; k < std::min(names.size(), fields.size()); ++k)
        if (const auto value = ParseValue(fields[k], has_decimal_commas))
          values.emplace(std::string(names[k]), *value);
      continue;
    }
    if (row == 0 && DeclaredDelimiter(lines[row])) continue;
    if (!comment) break;
    const size_t first = FindSeparator(*comment, 0);
    if (first == std::string_view::npos || first == 0) continue;
    size_t last = first;
    for (size_t at = first; at != std::string_view::npos; at = FindSeparator(*comment, at + 1))
      last = at;
    if (const auto value = ParseValue(Trim(comment->substr(last + 1)), has_decimal_commas))
      values.emplace(std::string(Trim(comment->substr(0, first))), *value);
  }
  return values;
}

std::map<std::string, HeaderValue> ReadHeaderValues(const std::filesystem::path& file) {
  // Headers are far shorter. The rows below, of which there may be millions, are not read.
  constexpr size_t kMost = 1 << 18;
  std::ifstream stream(file, std::ios::binary);
  std::string content(kMost, '\0');
  stream.read(content.data(), static_cast<std::streamsize>(kMost));
  if (stream.bad() || (!stream.is_open())) throw InputError({file.string()}, "cannot be read");
  content.resize(static_cast<size_t>(stream.gcount()));
  if (content.substr(0, 3) == "\xEF\xBB\xBF") content.erase(0, 3);
  return HeaderValuesIn(content);
}

std::vector<double> HeaderValuesOf(const std::vector<std::filesystem::path>& files,
                                   const std::string& name, double unit,
                                   const std::string& unit_name) {
  std::vector<double> all;
  for (const std::filesystem::path& file : files) {
    const std::map<std::string, HeaderValue> values = ReadHeaderValues(file);
    const auto found = values.find(name);
    if (found == values.end()) {
      std::vector<std::string> names;
      for (const auto& [other, value] : values) names.push_back(other);
      throw InputError(
          {file.string()},
          fmt::format("has no value \"{}\" in its header, which has {}", name,
                      names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
    }
    const HeaderValue& value = found->second;
    if (!value.unit.empty() && value.unit != unit_name)
      throw InputError({file.string()}, fmt::format("gives \"{}\" in {}; recording.yaml says {}",
                                                    name, value.unit, unit_name));
    if (!std::isfinite(value.value))
      throw InputError({file.string()}, fmt::format("gives no finite \"{}\"", name));
    all.push_back(unit * value.value);
  }
  return all;
}

}  // namespace lacuna
