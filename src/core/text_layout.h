// Layout of UTF-8 text for a terminal: widths, columns and line breaks.
#ifndef LACUNA_CORE_TEXT_LAYOUT_H_
#define LACUNA_CORE_TEXT_LAYOUT_H_

#include <string>
#include <string_view>

namespace lacuna {

inline constexpr size_t kTerminalWidth = 100;  // the default width of a paragraph, characters

// The number of characters (code points) of `text`.
size_t DisplayWidth(std::string_view text);

// `text` padded to `width` characters with spaces after it (PaddedRight) or before it (PaddedLeft).
// At least one space is added, even if the result is then longer than `width`.
std::string PaddedRight(std::string_view text, size_t width);
std::string PaddedLeft(std::string_view text, size_t width);

// The words of `text` as a paragraph of lines with at most `width` characters; a longer word forms
// a line by itself. The first line begins with `first`, the other lines begin with `margin`, and
// each line ends with a newline.
std::string Wrapped(std::string_view text, std::string_view first, std::string_view margin,
                    size_t width = kTerminalWidth);

}  // namespace lacuna

#endif  // LACUNA_CORE_TEXT_LAYOUT_H_
