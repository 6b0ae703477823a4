// Numbers that take a whole word of a text.
#ifndef LACUNA_CORE_PARSED_WORD_H_
#define LACUNA_CORE_PARSED_WORD_H_

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace lacuna {

// The number that `word` consists of, in decimal digits and independent of the locale, as
// std::from_chars reads it: without blanks and without a plus sign. std::nullopt where it is
// anything else, or out of the range of `Number`.
template <typename Number>
std::optional<Number> ParseWord(std::string_view word) {
  Number number{};
  const char* const end = word.data() + word.size();
  const auto [last, problem] = std::from_chars(word.data(), end, number);
  if (problem != std::errc() || last != end) return std::nullopt;
  return number;
}

// The same, where a plus sign may precede the digits.
template <typename Number>
std::optional<Number> ParseSignedWord(std::string_view word) {
  if (word.starts_with("+-")) return std::nullopt;
  if (word.starts_with('+')) word.remove_prefix(1);
  return ParseWord<Number>(word);
}

}  // namespace lacuna

#endif  // LACUNA_CORE_PARSED_WORD_H_
