// Texts whose letters may be upper or lower case.
#ifndef LACUNA_CORE_LETTER_CASE_H_
#define LACUNA_CORE_LETTER_CASE_H_

#include <cctype>
#include <string>
#include <string_view>

namespace lacuna {

// The text with its ASCII letters in lower case.
inline std::string InLowerCase(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

}  // namespace lacuna

#endif  // LACUNA_CORE_LETTER_CASE_H_
