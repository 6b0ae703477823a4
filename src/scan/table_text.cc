#include "scan/table_text.h"

#include <algorithm>
#include <cctype>

#include "core/error.h"
#include "core/text_file.h"
#include "scan/table_numbers.h"

namespace lacuna {
namespace {

constexpr std::string_view kBlanksAndLineEnds = " \t\r\n";

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

}  // namespace

bool IsSameLetter(char a, char b, bool case_counts) {
  if (case_counts) return a == b;
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

std::string_view Trim(std::string_view text) {
  const size_t begin = text.find_first_not_of(kBlanksAndLineEnds);
  if (begin == std::string_view::npos) return text.substr(0, 0);
  return text.substr(begin, text.find_last_not_of(kBlanksAndLineEnds) - begin + 1);
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
    size_t at = line.find_first_not_of(kBlanksAndLineEnds);
    while (at != std::string_view::npos) {
      const size_t end = line.find_first_of(kBlanksAndLineEnds, at);
      fields.push_back(line.substr(at, end == std::string_view::npos ? end : end - at));
      at = line.find_first_not_of(kBlanksAndLineEnds, end);
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

bool AreEmpty(const std::vector<std::string_view>& fields) {
  return std::all_of(fields.begin(), fields.end(),
                     [](std::string_view field) { return field.empty(); });
}

bool AreNumbers(const std::vector<std::string_view>& fields) {
  return std::all_of(fields.begin(), fields.end(),
                     [](std::string_view field) { return ParseDecimal(field).has_value(); });
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

}  // namespace lacuna
