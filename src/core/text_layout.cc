#include "core/text_layout.h"

#include <algorithm>
#include <sstream>

#include "core/utf8.h"

namespace lacuna {
namespace {

std::string Spaces(std::string_view text, size_t width) {
  const size_t own = DisplayWidth(text);
  return std::string(own < width ? width - own : 1, ' ');
}

}  // namespace

size_t DisplayWidth(std::string_view text) {
  return static_cast<size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return !ContinuesCharacter(c); }));
}

std::string PaddedRight(std::string_view text, size_t width) {
  return std::string(text) + Spaces(text, width);
}

std::string PaddedLeft(std::string_view text, size_t width) {
  return Spaces(text, width) + std::string(text);
}

std::string Wrapped(std::string_view text, std::string_view first, std::string_view margin,
                    size_t width) {
  std::istringstream words{std::string(text)};
  std::string lines, line(first);
  bool is_empty = true;
  for (std::string word; words >> word; is_empty = false) {
    if (!is_empty && DisplayWidth(line) + 1 + DisplayWidth(word) > width) {
      lines += line + "\n";
      line = margin;
      is_empty = true;
    }
    line += (is_empty ? "" : " ") + word;
  }
  return lines + line + "\n";
}

}  // namespace lacuna
