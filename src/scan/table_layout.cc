#include "scan/table_layout.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "scan/table_numbers.h"
#include "scan/table_text.h"

namespace lacuna {
namespace {

constexpr std::string_view kDelimiters = ";,\t";

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

bool IsCount(std::string_view line, std::string_view rest) {
  const std::optional<double> count = ParseNumber(line);
  if (!count || !(*count >= 1) || *count != std::floor(*count)) return false;
  const std::string_view next = NextRow(rest);
  return SplitFields(next, FindDelimiter(next, "")).size() >= 3;
}

}  // namespace lacuna
