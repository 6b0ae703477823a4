// Text for a terminal: widths, columns and line breaks, in characters of UTF-8.
#ifndef LACUNA_CORE_TEXT_LAYOUT_H_
#define LACUNA_CORE_TEXT_LAYOUT_H_

#include <string>
#include <string_view>

namespace lacuna {

inline constexpr size_t kTerminalWidth = 100;

// Characters: bytes that begin one.
size_t DisplayWidth(std::string_view text);

// With spaces behind it, or before it, up to the width; at least one where it is longer.
std::string PaddedRight(std::string_view text, size_t width);
std::string PaddedLeft(std::string_view text, size_t width);

// Lines of at most `width` characters, unless a word is longer, each ended. The first begins with
// `first`, further ones with `margin`.
std::string Wrapped(std::string_view text, std::string_view first, std::string_view margin,
                    size_t width = kTerminalWidth);

}  // namespace lacuna

#endif  // LACUNA_CORE_TEXT_LAYOUT_H_
