#include "scan/delimited_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/error.h"
#include "core/text_file.h"

namespace lacuna {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";
constexpr std::string_view kDelimiters = ";,\t";

std::string_view Unquote(std::string_view text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    return Trim(text.substr(1, text.size() - 2));
  }
  return text;
}

// The place of the quote that closes the entry opened at `begin`: two quotes stand for one in it.
size_t FindClosingQuote(std::string_view line, size_t begin) {
  size_t end = line.find('"', begin + 1);
  while (end != std::string_view::npos && line.substr(end + 1).starts_with('"'))
    end = line.find('"', end + 2);
  return end;
}

// `entry` with one quote in the place of two.
std::string WithSingleQuotes(std::string_view entry) {
  std::string text;
  for (size_t at = 0; at < entry.size(); ++at) {
    text += entry[at];
    if (entry.substr(at, 2) == "\"\"") ++at;
  }
  return text;
}

// A number with a decimal point or a decimal comma.
std::optional<double> ParseEntry(std::string_view text) {
  if (const std::optional<double> value = ParseNumber(text)) return value;
  std::string with_point(text);
  const size_t comma = with_point.find(',');
  if (comma == std::string::npos || with_point.find('.') != std::string::npos) return std::nullopt;
  with_point[comma] = '.';
  return ParseNumber(with_point);
}

bool AreNumbers(const std::vector<std::string_view>& fields) {
  return std::all_of(fields.begin(), fields.end(),
                     [](std::string_view field) { return ParseEntry(field).has_value(); });
}

// `line` without what stands in quotes, or all of it where no delimiter is outside of them.
std::string OutsideQuotes(std::string_view line) {
  std::string outside;
  bool is_quoted = false;
  for (const char c : line) {
    if (c == '"') is_quoted = !is_quoted;
    if (!is_quoted) outside += c;
  }
  return outside.find_first_of(kDelimiters) == std::string::npos ? std::string(line) : outside;
}

char FindDelimiter(std::string_view line) {
  const std::string outside = OutsideQuotes(line);
  const auto has = [&outside](char c) { return outside.find(c) != std::string::npos; };
  if (has(';')) return ';';
  if (has(',')) {
    // The commas are decimal ones where tabs or blanks cut the line into numbers.
    for (const char candidate : {'\t', ' '}) {
      const std::vector<std::string_view> fields = SplitFields(line, candidate);
      if (has(candidate) && fields.size() > 1 && AreNumbers(fields)) return candidate;
    }
    return ',';
  }
  return has('\t') ? '\t' : ' ';
}

// Whether `line` is a title above the names of the columns, which `rest` begins with.
bool IsTitle(std::string_view line, std::string_view rest) {
  if (line.find_first_of(kDelimiters) != std::string_view::npos ||
      AreNumbers(SplitFields(line, ' ')))
    return false;
  const std::string_view next = Trim(rest.substr(0, rest.find('\n')));
  if (next.find_first_of(kDelimiters) == std::string_view::npos || next.front() == '#')
    return false;
  return !AreNumbers(SplitFields(next, FindDelimiter(next)));
}

// Notes a header in which most entries are numbers with decimals: its line may be a row of data of
// which one entry cannot be read. Whole numbers are common names of channels.
void DoubtHeader(DelimitedTable* table, int line) {
  int numbers = 0, decimals = 0, words = 0;
  std::string word;
  for (const std::string& name : table->header) {
    const std::optional<double> value = ParseEntry(name);
    if (!value) word = name;
    words += !value;
    numbers += value && std::isfinite(*value);
    decimals += value && std::isfinite(*value) && *value != std::floor(*value);
  }
  if (decimals == 0 || numbers <= words) return;
  table->notes.push_back(fmt::format(
      "{}:{}: the first line was taken for the names of the columns because of \"{}\", but {} of "
      "its {} entries are numbers",
      table->file.string(), line, word, numbers, table->header.size()));
}

// Notes a first row 0, 1, 2, … or 1, 2, 3, … above rows that are not whole numbers.
void DoubtFirstRow(DelimitedTable* table) {
  const Eigen::MatrixXd& values = table->values;
  if (!table->header.empty() || values.cols() < 3 || values.rows() < 3) return;
  const double first = values(0, 0);
  if (first != 0 && first != 1) return;
  for (Eigen::Index c = 0; c < values.cols(); ++c) {
    if (values(0, c) != first + static_cast<double>(c)) return;
  }
  const auto below = values.bottomRows(values.rows() - 1).array();
  if (((below - below.floor()) == 0).rowwise().all().any()) return;
  table->notes.push_back(fmt::format(
      "{}:{}: the first line, {:g}, {:g}, {:g}{}, was read as a row of data; if it numbers the "
      "columns, remove it or put a # in front",
      table->file.string(), table->line[0], first, first + 1, first + 2,
      values.cols() > 3 ? ", …" : ""));
}

}  // namespace

std::string_view Trim(std::string_view text) {
  const size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return text.substr(0, 0);
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::vector<std::string_view> SplitLines(std::string_view content) {
  std::vector<std::string_view> lines;
  for (size_t at = 0; at < content.size();) {
    const size_t end = std::min(content.find('\n', at), content.size());
    std::string_view line = content.substr(at, end - at);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    lines.push_back(line);
    at = end + 1;
  }
  return lines;
}

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
    // A quoted entry may contain the delimiter.
    size_t from = line.find_first_not_of(' ', at);
    const bool is_quoted = from != std::string_view::npos && line[from] == '"';
    if (is_quoted) from = FindClosingQuote(line, from);
    const size_t end =
        line.find(delimiter, is_quoted && from != std::string_view::npos ? from : at);
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

std::string ReadFilledText(const std::filesystem::path& file) {
  std::string content = ReadTextFile(file);
  if (content.empty()) throw InputError({file.string()}, "is empty");
  return content;
}

DelimitedTable ReadDelimitedTable(const std::filesystem::path& file) {
  const std::string content = ReadFilledText(file);
  DelimitedTable table;
  table.file = file;
  std::vector<double> entries;
  size_t width = 0;
  char delimiter = 0;
  int line_number = 0;
  std::string_view comment;  // the last above the first row
  for (size_t at = 0; at < content.size();) {
    const size_t end = std::min(content.find('\n', at), content.size());
    const std::string_view line(content.data() + at, end - at);
    at = end + 1;
    ++line_number;
    if (Trim(line).empty()) continue;
    if (Trim(line).front() == '#') {
      if (width > 0) continue;
      comment = Trim(line);
      comment.remove_prefix(std::min(comment.find_first_not_of('#'), comment.size()));
      comment = Trim(comment);
      table.comments.emplace_back(comment);
      continue;
    }
    if (width == 0 && Trim(line) == kStageHeader) {
      at = std::min(content.find('\n', at), content.size() - 1) + 1;  // and the line below
      ++line_number;
      continue;
    }
    if (width == 0 && Trim(line).substr(0, 3) == "***") continue;
    if (delimiter == 0 &&
        IsTitle(Trim(line), std::string_view(content).substr(std::min(at, content.size()))))
      continue;
    if (delimiter == 0) delimiter = FindDelimiter(Trim(line));
    const std::vector<std::string_view> fields = SplitFields(line, delimiter);
    if (width == 0) {
      width = fields.size();
      if (!comment.empty()) {
        const std::vector<std::string_view> names = SplitFields(comment, delimiter);
        if (names.size() == width) table.commented_header.assign(names.begin(), names.end());
      }
      if (!AreNumbers(fields)) {
        std::transform(fields.begin(), fields.end(), std::back_inserter(table.header),
                       WithSingleQuotes);
        DoubtHeader(&table, line_number);
        continue;
      }
    }
    if (fields.size() != width) {
      const bool may_be_decimal = delimiter == ',' && fields.size() == 2 * width;
      throw InputError(
          {file.string(), line_number, 1},
          fmt::format("has {} entries where the first line has {}{}", fields.size(), width,
                      may_be_decimal ? "; decimal commas need another delimiter, such as ;" : ""));
    }
    for (const std::string_view field : fields) {
      const std::optional<double> value = ParseEntry(field);
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
  DoubtFirstRow(&table);
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
  const auto is_same_letter = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) ==
           std::tolower(static_cast<unsigned char>(b));
  };
  std::optional<Eigen::Index> similar;
  for (size_t column = 0; column < table.header.size(); ++column) {
    const std::string& other = table.header[column];
    if (!std::equal(name.begin(), name.end(), other.begin(), other.end(), is_same_letter)) continue;
    if (similar) return std::nullopt;
    similar = column;
  }
  return similar;
}

Eigen::Index RequireColumn(const DelimitedTable& table, const std::string& name) {
  if (const std::optional<Eigen::Index> column = FindColumn(table, name)) return *column;
  const std::string there =
      table.header.empty() ? fmt::format("it has no header and {} columns", table.values.cols())
                           : fmt::format("its columns are {}", fmt::join(table.header, ", "));
  throw InputError({table.file.string()}, fmt::format("has no column \"{}\"; {}", name, there));
}

}  // namespace lacuna
