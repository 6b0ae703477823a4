#include "geometry/text_scanner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/letter_case.h"
#include "core/parsed_word.h"
#include "core/text_file.h"

namespace lacuna {
namespace {

constexpr std::string_view kBlank = " \t\r\v\f";

}  // namespace

std::string LowerExtension(const std::filesystem::path& file) {
  return InLowerCase(file.extension().string());
}

TextScanner::TextScanner(const std::filesystem::path& file, char comment)
    : file_(file), content_(ReadTextFile(file)), comment_(comment) {}

bool TextScanner::NextLine() {
  while (next_line_ < content_.size()) {
    const size_t end = std::min(content_.find('\n', next_line_), content_.size());
    rest_ = std::string_view(content_).substr(next_line_, end - next_line_);
    next_line_ = end + 1;
    ++line_number_;
    if (comment_ != '\0') rest_ = rest_.substr(0, rest_.find(comment_));
    if (!AtLineEnd()) return true;
  }
  rest_ = {};
  return false;
}

void TextScanner::ExpectLine(const std::string& what) {
  if (!NextLine()) Fail("the file ends where " + what + " should follow");
}

bool TextScanner::AtLineEnd() { return rest_.find_first_not_of(kBlank) == std::string_view::npos; }

int TextScanner::WordsLeft() const {
  int count = 0;
  for (size_t at = rest_.find_first_not_of(kBlank); at != std::string_view::npos; ++count) {
    at = rest_.find_first_of(kBlank, at);
    if (at != std::string_view::npos) at = rest_.find_first_not_of(kBlank, at);
  }
  return count;
}

std::string_view TextScanner::Word(const char* what) {
  if (AtLineEnd()) Fail(fmt::format("the line ends where {} should follow", what));
  rest_.remove_prefix(rest_.find_first_not_of(kBlank));
  const std::string_view word = rest_.substr(0, rest_.find_first_of(kBlank));
  rest_.remove_prefix(word.size());
  return word;
}

std::string_view TextScanner::WordAnywhere(const char* what) {
  if (AtLineEnd()) ExpectLine(what);
  return Word(what);
}

double TextScanner::Number(const char* what) {
  const std::string_view word = Word(what);
  const auto value = ParseSignedWord<double>(word);
  if (!value) Fail(fmt::format("got \"{}\"; expected {}", word, what));
  if (!std::isfinite(*value)) Fail(fmt::format("{} is not finite: {}", what, word));
  return *value;
}

long long TextScanner::Integer(const char* what) {
  const std::string_view word = Word(what);
  const auto value = ParseSignedWord<long long>(word);
  if (!value) Fail(fmt::format("got \"{}\"; expected {}", word, what));
  return *value;
}

long long TextScanner::Count(const char* what) {
  const long long count = Integer(what);
  if (count < 0) Fail(fmt::format("got {}; expected {}", count, what));
  return count;
}

Eigen::Vector3d TextScanner::Point(const char* what) {
  const double x = Number(what), y = Number(what), z = Number(what);
  return {x, y, z};
}

void TextScanner::Fail(const std::string& message) const {
  throw InputError({file_.string(), line_number_}, message);
}

}  // namespace lacuna
