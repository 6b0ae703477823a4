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
#include "scan/column_name.h"
#include "scan/table_numbers.h"

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

bool AreNumbers(const std::vector<std::string_view>& fields) {
  return std::all_of(fields.begin(), fields.end(),
                     [](std::string_view field) { return ParseDecimal(field).has_value(); });
}

bool AreEmpty(const std::vector<std::string_view>& fields) {
  return std::all_of(fields.begin(), fields.end(),
                     [](std::string_view field) { return field.empty(); });
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

// The first line of `rest` that is neither empty nor a comment.
std::string_view NextRow(std::string_view rest) {
  while (!rest.empty()) {
    const size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = Trim(rest.substr(0, end));
    if (!line.empty() && line.front() != '#') return line;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return rest;
}

// Whether `delimiter` divides a line of names and the row of numbers below it into as many entries.
bool DividesAlike(std::string_view names, std::string_view row, char delimiter) {
  const size_t count = SplitFields(names, delimiter).size();
  const std::vector<std::string_view> fields = SplitFields(row, delimiter);
  return count > 1 && fields.size() == count && AreNumbers(fields);
}

// The delimiter of a table of which `line` is the first line and `rest` what follows it.
char FindDelimiter(std::string_view line, std::string_view rest) {
  const std::string outside = OutsideQuotes(line);
  const auto has = [&outside](char c) { return outside.find(c) != std::string::npos; };
  if (has('\t') && (has(';') || has(','))) {
    // Names may contain the other delimiters, as "Time, s" does.
    const std::string_view row = NextRow(rest);
    if (DividesAlike(line, row, '\t') && !DividesAlike(line, row, has(';') ? ';' : ','))
      return '\t';
  }
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

// The length of the title above the names of the columns, with which `text` begins; 0: it has none.
size_t LengthOfTitle(std::string_view text) {
  constexpr int kMostLines = 8;
  size_t at = 0;
  for (int row = 0; row < kMostLines && at < text.size(); ++row) {
    const size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = Trim(text.substr(at, end - at));
    if (line.find_first_of(kDelimiters) != std::string_view::npos) {
      if (row == 0 || line.front() == '#') return 0;
      return AreNumbers(SplitFields(line, FindDelimiter(line, text.substr(end)))) ? 0 : at;
    }
    const std::vector<std::string_view> words = SplitFields(line, ' ');
    if (AreNumbers(words) && (row == 0 || words.size() > 1)) return 0;
    at = std::min(end + 1, text.size());
  }
  return 0;
}

// Whether `line` is the number of the points in the rows below it, which `rest` begins with.
bool IsCount(std::string_view line, std::string_view rest) {
  const std::optional<double> count = ParseNumber(line);
  if (!count || !(*count >= 1) || *count != std::floor(*count)) return false;
  const std::string_view next = NextRow(rest);
  return SplitFields(next, FindDelimiter(next, "")).size() >= 3;
}

std::string_view WithoutBrackets(std::string_view text) {
  const bool has_brackets = text.size() > 2 && ((text.front() == '(' && text.back() == ')') ||
                                                (text.front() == '[' && text.back() == ']'));
  return has_brackets ? Trim(text.substr(1, text.size() - 2)) : text;
}

// The names of columns that two lines give: in groups, and in them. Empty where the first line
// groups no columns, i.e. has neither a missing name nor the same name twice side by side.
std::vector<std::string> GroupedNames(const std::vector<std::string>& groups,
                                      const std::vector<std::string_view>& own) {
  std::vector<std::string> names;
  std::string group;
  bool has_groups = false;
  for (size_t k = 0; k < groups.size(); ++k) {
    const bool continues = k > 0 && (groups[k].empty() || groups[k] == groups[k - 1]);
    has_groups = has_groups || ((continues || groups[k].empty()) && !own[k].empty());
    if (!groups[k].empty()) group = groups[k];
    const std::string& own_group = own[k].empty() ? groups[k] : group;
    names.push_back(own_group + (own_group.empty() || own[k].empty() ? "" : "_") +
                    std::string(own[k]));
  }
  return has_groups ? names : std::vector<std::string>();
}

// Takes a line below the names that holds no number for the second line of the names of groups, or
// for the units, if one of its entries is a unit or in brackets. Returns whether it is one of
// these.
bool TakeSecondHeader(const std::vector<std::string_view>& fields, DelimitedTable* table) {
  if (table->header.empty() || !table->units.empty() || fields.size() != table->header.size() ||
      AreNumbers(fields))
    return false;
  int units = 0, words = 0;
  for (const std::string_view field : fields) {
    const std::optional<double> number = ParseDecimal(field);
    if (number && std::isfinite(*number)) return false;
    if (number) continue;
    ++(WithoutBrackets(field) != field || ParsedUnit(field) ? units : words);
  }
  if (words > 0) {
    const std::vector<std::string> names = GroupedNames(table->header, fields);
    if (!names.empty()) {
      table->header = names;
      return true;
    }
  }
  if (units == 0) return false;
  for (const std::string_view field : fields) table->units.emplace_back(WithoutBrackets(field));
  return true;
}

// Whether a text that is no number looks like a date or a time of day.
bool IsDate(std::string_view text) {
  const auto count = [text](char c) { return std::count(text.begin(), text.end(), c); };
  return !text.empty() && std::isdigit(static_cast<unsigned char>(text.front())) &&
         (count(':') > 0 || count('-') > 1 || count('/') > 1 || count('.') > 1);
}

// Notes a header in which most entries are numbers with decimals: its line may be a row of data of
// which one entry cannot be read. Whole numbers are common names of channels.
void DoubtHeader(DelimitedTable* table, int line) {
  int numbers = 0, decimals = 0, words = 0;
  std::string word;
  for (const std::string& name : table->header) {
    const std::optional<double> value = ParseDecimal(name);
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

std::optional<char> DeclaredDelimiter(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  if (line.size() == 7 && line.front() == '"' && line.back() == '"') line = line.substr(1, 5);
  if (line.size() != 5 || (line.substr(0, 4) != "sep=" && line.substr(0, 4) != "SEP="))
    return std::nullopt;
  return std::string_view(";,\t| ").find(line[4]) == std::string_view::npos
             ? std::nullopt
             : std::optional<char>(line[4]);
}

bool IsSameLetter(char a, char b, bool case_counts) {
  if (case_counts) return a == b;
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

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
  DecimalCommas commas;
  struct EmptyRow {
    int line;
    size_t width;
  };
  std::vector<EmptyRow> empty_rows;  // those that no other row has followed so far
  const auto check_width = [&](int line, size_t entry_count) {
    if (entry_count == width) return;
    const bool may_be_decimal = delimiter == ',' && entry_count == 2 * width;
    throw InputError(
        {file.string(), line, 1},
        fmt::format("has {} entries where the first line has {}{}", entry_count, width,
                    may_be_decimal ? "; decimal commas need another delimiter, such as ;" : ""));
  };
  for (size_t at = 0; at < content.size();) {
    const size_t begin = at, end = std::min(content.find('\n', at), content.size());
    std::string_view line(content.data() + at, end - at);
    at = end + 1;
    ++line_number;
    const std::string_view rest = std::string_view(content).substr(std::min(at, content.size()));
    if (const auto declared = DeclaredDelimiter(line); declared && line_number == 1) {
      delimiter = *declared;
      continue;
    }
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
    if (table.line.empty() && IsCount(Trim(line), rest)) continue;
    if (delimiter == 0) {
      const std::string_view from = std::string_view(content).substr(begin);
      if (const size_t title = LengthOfTitle(from); title > 0) {
        at = begin + title;
        line_number += static_cast<int>(std::count(from.begin(), from.begin() + title, '\n')) - 1;
        continue;
      }
      if (Trim(line).starts_with("//")) line.remove_prefix(line.find("//") + 2);
      delimiter = FindDelimiter(Trim(line), rest);
    }
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
    if (table.line.empty() && TakeSecondHeader(fields, &table)) continue;
    if (AreEmpty(fields)) {
      empty_rows.push_back({line_number, fields.size()});
      continue;
    }
    for (const EmptyRow& empty : empty_rows) {
      check_width(empty.line, empty.width);
      entries.insert(entries.end(), width, std::numeric_limits<double>::quiet_NaN());
      table.line.push_back(empty.line);
    }
    empty_rows.clear();
    check_width(line_number, fields.size());
    for (const std::string_view field : fields) {
      const int column = static_cast<int>(field.data() - line.data()) + 1;
      const std::optional<double> value = ParseDecimal(field);
      if (!value)
        throw InputError({file.string(), line_number, column},
                         fmt::format("got \"{}\"; expected a number{}", field,
                                     IsDate(field) ? ", such as seconds since the first row: dates "
                                                     "and times of day are not read"
                                                   : ""));
      commas.Add(field, line_number, column);
      entries.push_back(*value);
    }
    table.line.push_back(line_number);
  }
  if (table.line.empty()) throw InputError({file.string()}, "holds no row of numbers");
  commas.RefuseThousands(file, delimiter);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  table.values = Eigen::Map<const RowMajor>(entries.data(), table.line.size(), width);
  DoubtFirstRow(&table);
  return table;
}

std::optional<Eigen::Index> FindColumn(const DelimitedTable& table, const std::string& name) {
  const std::vector<Eigen::Index> same = ColumnsNamed(table, name, /*case_counts=*/true);
  if (!same.empty()) return OnlyColumn(table, name, same);
  int number = 0;
  const auto [end, problem] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (problem == std::errc() && end == name.data() + name.size() && number >= 1 &&
      number <= table.values.cols()) {
    return number - 1;
  }
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
