// A text in double quotes, in the syntax that YAML and JSON share.
#ifndef LACUNA_CORE_QUOTED_TEXT_H_
#define LACUNA_CORE_QUOTED_TEXT_H_

#include <string>

namespace lacuna {

// `text` in double quotes, which is read back as the same text whatever characters it holds. Bytes
// that are not ASCII stay as they are.
inline std::string QuotedText(const std::string& text) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string quoted = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code == 0x7f) {
      quoted += std::string("\\u00") + kDigits[code / 16] + kDigits[code % 16];
    } else {
      if (c == '"' || c == '\\') quoted += '\\';
      quoted += c;
    }
  }
  return quoted + '"';
}

}  // namespace lacuna

#endif  // LACUNA_CORE_QUOTED_TEXT_H_
