#include "exchange/inp_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/parsed_word.h"
#include "core/text_file.h"

namespace lacuna {
namespace {

constexpr std::string_view kBlank = " \t\r\v\f";

std::string_view Trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

bool IsControl(char c) {
  const auto code = static_cast<unsigned char>(c);
  return (code < 0x20 && c != '\t') || code == 0x7f;
}

std::vector<std::string_view> Split(std::string_view text) {
  std::vector<std::string_view> fields;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    fields.push_back(Trimmed(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return fields;
}

}  // namespace

std::string InpName(std::string_view text) {
  text = Trimmed(text);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
    text = text.substr(1, text.size() - 2);
  std::string capitals(text);
  std::transform(capitals.begin(), capitals.end(), capitals.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  return capitals;
}

InpLines::InpLines(const std::filesystem::path& file) : file_(file), content_(ReadTextFile(file)) {}

bool InpLines::NextText(std::string_view* text) {
  while (next_ < content_.size()) {
    const size_t end = std::min(content_.find('\n', next_), content_.size());
    *text = Trimmed(std::string_view(content_).substr(next_, end - next_));
    next_ = end + 1;
    ++line_;
    if (!text->empty() && !text->starts_with("**")) return true;
  }
  return false;
}

void InpLines::ReadKeyword(std::string_view text) {
  keyword_text_ = std::string(text);
  keyword_line_ = line_;
  parameters_.clear();
  bool is_first = true;
  for (bool continues = true; continues;) {
    // Names are written into YAML files, where a carriage return ends a line.
    if (std::any_of(text.begin(), text.end(), IsControl))
      Fail("a keyword line holds a control character");
    continues = text.ends_with(',');
    for (const std::string_view field : Split(is_first ? text.substr(1) : text)) {
      if (is_first) {
        keyword_ = InpName(field);
        is_first = false;
        continue;
      }
      if (field.empty()) continue;
      const size_t equals = field.find('=');
      const std::string name = InpName(field.substr(0, equals));
      const std::string value =
          equals == std::string_view::npos ? "" : InpName(field.substr(equals + 1));
      if (!parameters_.emplace(name, value).second)
        Fail(fmt::format("the parameter {} appears twice", name));
    }
    if (continues && !NextText(&text))
      Fail("the file ends where a keyword line should continue after its comma");
    if (continues && std::isalpha(static_cast<unsigned char>(text.front())) == 0)
      Fail(fmt::format("the keyword line above ends with a comma; got \"{}\"; expected a parameter",
                       text));
  }
}

bool InpLines::Next() {
  std::string_view text;
  if (!NextText(&text)) return false;
  is_keyword_ = text.front() == '*';
  if (is_keyword_) {
    ReadKeyword(text);
    return true;
  }
  ends_with_comma_ = text.back() == ',';
  fields_ = Split(text);
  if (ends_with_comma_) fields_.pop_back();
  return true;
}

const std::string* InpLines::Parameter(const std::string& name) const {
  const auto found = parameters_.find(name);
  return found == parameters_.end() ? nullptr : &found->second;
}

const std::string& InpLines::RequiredParameter(const std::string& name) const {
  const std::string* value = Parameter(name);
  if (value == nullptr || value->empty()) Fail(fmt::format("*{} needs {}=…", keyword_, name));
  return *value;
}

void InpLines::RefuseParametersBut(const std::set<std::string>& known) const {
  for (const auto& [name, value] : parameters_)
    if (!known.contains(name)) Fail(fmt::format("*{} with {} is not read", keyword_, name));
}

double InpLines::Number(size_t k, const char* what) const {
  if (k >= fields_.size()) Fail(fmt::format("the line ends where {} should follow", what));
  std::string word(fields_[k]);
  // Fortran's exponent.
  std::replace_if(
      word.begin(), word.end(), [](char c) { return c == 'd' || c == 'D'; }, 'e');
  const auto value = ParseSignedWord<double>(word);
  if (!value || !std::isfinite(*value))
    Fail(fmt::format("got \"{}\"; expected {}, a finite number", fields_[k], what));
  return *value;
}

int InpLines::Label(size_t k, const char* what) const {
  if (k >= fields_.size()) Fail(fmt::format("the line ends where {} should follow", what));
  const std::string_view word = fields_[k];
  const auto value = ParseWord<int>(word);
  if (!value || *value < 1)
    Fail(fmt::format("got \"{}\"; expected {}, a whole number from 1 to {}", word, what,
                     std::numeric_limits<int>::max()));
  return *value;
}

void InpLines::Fail(const std::string& message) const {
  throw InputError({file_.string(), line_}, message);
}

}  // namespace lacuna
