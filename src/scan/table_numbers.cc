#include "scan/table_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>

#include "core/error.h"
#include "core/letter_case.h"
#include "core/parsed_word.h"

namespace lacuna {

std::optional<double> ParseNumber(std::string_view text) {
  if (text.empty()) return std::numeric_limits<double>::quiet_NaN();
  return ParseSignedWord<double>(text);
}

bool IsMissing(std::string_view text) {
  const std::string lower = InLowerCase(text);
  if (lower.starts_with("1.#") || lower.starts_with("-1.#")) return !lower.ends_with("#inf");
  constexpr std::array<std::string_view, 7> kWords{"na", "n/a", "#n/a", "null", "none", "-", "--"};
  return std::find(kWords.begin(), kWords.end(), lower) != kWords.end();
}

std::optional<double> ParseDecimal(std::string_view text) {
  if (const std::optional<double> value = ParseNumber(text)) return value;
  if (IsMissing(text)) return std::numeric_limits<double>::quiet_NaN();
  std::string with_point(text);
  const size_t comma = with_point.find(',');
  if (comma == std::string::npos || with_point.find('.') != std::string::npos) return std::nullopt;
  with_point[comma] = '.';
  return ParseNumber(with_point);
}

bool MayBeThousands(std::string_view text) {
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  const size_t comma = text.find(',');
  if (comma == std::string_view::npos || comma < 1 || comma > 3 || text.size() != comma + 4)
    return false;
  if (text.front() == '0') return false;
  return std::all_of(text.begin(), text.end(), [](char c) {
    return c == ',' || std::isdigit(static_cast<unsigned char>(c)) != 0;
  });
}

void DecimalCommas::Add(std::string_view entry, int line, int column) {
  if (entry.find(',') == std::string_view::npos) {
    has_point_ = has_point_ || entry.find('.') != std::string_view::npos;
  } else if (!MayBeThousands(entry)) {
    is_certain_ = true;
  } else if (doubtful_.empty()) {
    doubtful_ = entry;
    line_ = line;
    column_ = column;
  }
}

void DecimalCommas::RefuseThousands(const std::filesystem::path& file, char delimiter) const {
  if (doubtful_.empty()) return;
  if (!has_point_ && (is_certain_ || delimiter != ',')) return;
  std::string thousands = doubtful_, decimal = doubtful_;
  thousands.erase(thousands.find(','), 1);
  decimal[decimal.find(',')] = '.';
  throw InputError(
      {file.string(), line_, column_},
      fmt::format("got \"{}\", which is {} with a thousands separator and {} with a decimal "
                  "comma; write the numbers of the file without such commas",
                  doubtful_, thousands, decimal));
}

}  // namespace lacuna
