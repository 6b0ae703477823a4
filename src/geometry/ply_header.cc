#include "geometry/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "core/error.h"
#include "core/parsed_word.h"

namespace lacuna {
namespace {

constexpr std::array kFloatingTypes{"float", "float32", "double", "float64"};
constexpr std::array kBytesOfFloating{4, 4, 8, 8};
constexpr std::array kIntegerTypes{"char",   "int8",   "uchar", "uint8", "short", "int16",
                                   "ushort", "uint16", "int",   "int32", "uint",  "uint32"};

constexpr std::array kBytesOfInteger{1, 1, 1, 1, 2, 2, 2, 2, 4, 4, 4, 4};

// 0: there is no such type.
size_t BytesOf(std::string_view type) {
  for (size_t k = 0; k < kFloatingTypes.size(); ++k)
    if (type == kFloatingTypes[k]) return kBytesOfFloating[k];
  for (size_t k = 0; k < kIntegerTypes.size(); ++k)
    if (type == kIntegerTypes[k]) return kBytesOfInteger[k];
  return 0;
}

template <typename Names>
bool Contains(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string_view> WordsOf(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r";
  std::vector<std::string_view> words;
  for (size_t at = 0; (at = line.find_first_not_of(kBlanks, at)) != std::string_view::npos;) {
    const size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

// One line after another of a header.
class HeaderReader {
 public:
  HeaderReader(const std::filesystem::path& file, std::string_view content)
      : file_(file), content_(content) {}

  PlyHeader Read() {
    if (Next() != std::vector<std::string_view>{"ply"})
      throw InputError({file_.string()}, "is not a PLY file");
    bool has_format = false;
    for (;;) {
      const std::vector<std::string_view> words = Next();
      const std::string_view key = words.empty() ? "" : words[0];
      if (key == "end_header") break;
      if (key == "format") {
        if (has_format) Fail("names the format a second time");
        if (words.size() != 3 || words[2] != "1.0") Fail("expected format NAME 1.0");
        has_format = true;
        header_.is_text = words[1] == "ascii";
        header_.is_big_endian = words[1] == "binary_big_endian";
        if (!header_.is_text && words[1] != "binary_little_endian" &&
            words[1] != "binary_big_endian")
          Fail(fmt::format("got \"{}\"; expected ascii, binary_little_endian or binary_big_endian",
                           words[1]));
      } else if (key == "element") {
        AddElement(words);
      } else if (key == "property") {
        AddProperty(words);
      } else if (key == "obj_info") {
        // PCL ends the program where this word is not the first of its line.
        if (key.data() != content_.data() + line_begin_) Fail("has a blank before obj_info");
      } else if (!words.empty() && key != "comment") {
        Fail(fmt::format("got \"{}\" in the header of a PLY file", key));
      }
    }
    if (!has_format) throw InputError({file_.string()}, "has a header without a format");
    header_.body = at_;
    RefuseMoreThanTheFileHolds();
    return std::move(header_);
  }

 private:
  [[noreturn]] void Fail(const std::string& message) const {
    throw InputError({file_.string(), line_}, message);
  }

  std::vector<std::string_view> Next() {
    const size_t end = content_.find('\n', at_);
    if (end == std::string_view::npos)
      throw InputError({file_.string()}, "is not a PLY file or ends within its header");
    ++line_;
    line_begin_ = at_;
    at_ = end + 1;
    return WordsOf(content_.substr(line_begin_, end - line_begin_));
  }

  // Other readers split lines at more kinds of white space than this one, form feeds for example,
  // and would find other words.
  void RequireName(std::string_view name) const {
    if (!std::all_of(name.begin(), name.end(), [](char c) { return c > ' ' && c <= '~'; }))
      Fail("has a name with a character that is not printable ASCII");
  }

  void AddElement(const std::vector<std::string_view>& words) {
    if (words.size() != 3) Fail("expected element NAME COUNT");
    RequireName(words[1]);
    PlyElement element;
    element.name = words[1];
    const auto count = ParseWord<size_t>(words[2]);
    if (!count) Fail(fmt::format("got \"{}\"; expected a number of \"{}\"", words[2], words[1]));
    element.count = *count;
    if (header_.Find(element.name) != nullptr)
      Fail(fmt::format("announces \"{}\" a second time", element.name));
    header_.elements.push_back(std::move(element));
  }

  void AddProperty(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) Fail("names a property before the first element");
    PlyProperty property;
    property.is_list = words.size() > 1 && words[1] == "list";
    if (words.size() != (property.is_list ? 5u : 3u))
      Fail("expected property TYPE NAME or property list TYPE TYPE NAME");
    property.name = words.back();
    RequireName(property.name);
    for (size_t k = property.is_list ? 2 : 1; k + 1 < words.size(); ++k)
      if (BytesOf(words[k]) == 0)
        Fail(fmt::format("got \"{}\"; expected the type of a property", words[k]));
    if (property.is_list && !Contains(kIntegerTypes, words[2]))
      Fail(fmt::format("got \"{}\"; the length of a list is an integer", words[2]));
    const std::string_view type = words[words.size() - 2];
    property.is_floating = Contains(kFloatingTypes, type);
    property.bytes = BytesOf(type);
    if (property.is_list) {
      property.bytes_of_length = BytesOf(words[2]);
      property.has_signed_length = words[2].front() != 'u';
    }
    PlyElement& element = header_.elements.back();
    if (FindProperty(element, property.name) != nullptr)
      Fail(fmt::format("names the property \"{}\" of \"{}\" a second time", property.name,
                       element.name));
    element.properties.push_back(std::move(property));
  }

  // A value takes a byte at least.
  void RefuseMoreThanTheFileHolds() const {
    const double bytes = static_cast<double>(content_.size() - header_.body);
    for (const PlyElement& element : header_.elements) {
      const size_t values = std::max<size_t>(1, element.properties.size());
      if (static_cast<double>(element.count) * static_cast<double>(values) <= bytes) continue;
      throw InputError({file_.string()},
                       fmt::format("is truncated or malformed: its header announces {} of \"{}\"",
                                   element.count, element.name));
    }
  }

  const std::filesystem::path& file_;
  const std::string_view content_;
  size_t at_ = 0, line_begin_ = 0;
  int line_ = 0;
  PlyHeader header_;
};

// Goes through the values of a body.
class BodyReader {
 public:
  BodyReader(const std::filesystem::path& file, std::string_view content, const PlyHeader& header)
      : file_(file), content_(content), header_(header), at_(header.body) {}

  void Check() {
    for (const PlyElement& element : header_.elements)
      for (size_t k = 0; k < element.count; ++k)
        for (const PlyProperty& property : element.properties)
          if (!Pass(property))
            throw InputError({file_.string()},
                             fmt::format("is truncated or malformed: it ends within \"{}\" of "
                                         "\"{}\" {} of {}",
                                         property.name, element.name, k + 1, element.count));
  }

 private:
  // False where the file ends before the end of the property.
  bool Pass(const PlyProperty& property) {
    uint64_t values = 1;
    if (property.is_list) {
      const std::optional<int64_t> length =
          header_.is_text ? LengthInText(property) : LengthInBytes(property);
      if (!length) return false;
      if (*length < 0)
        throw InputError(
            {file_.string()},
            fmt::format("is malformed: a list \"{}\" has the length {}", property.name, *length));
      values = static_cast<uint64_t>(*length);
    }
    const size_t rest = content_.size() - at_;
    if (values > rest) return false;
    if (!header_.is_text) {
      if (values > rest / property.bytes) return false;
      at_ += values * property.bytes;
      return true;
    }
    for (; values > 0; --values) {
      const std::string_view word = NextWord();
      if (word.empty()) return false;
      if (property.is_floating)
        RequireNumber<double>(word);
      else
        RequireNumber<int64_t>(word);
    }
    return true;
  }

  std::string_view NextWord() {
    constexpr std::string_view kBlanks = " \t\r\n";
    const size_t begin = content_.find_first_not_of(kBlanks, at_);
    if (begin == std::string_view::npos) return {};
    at_ = std::min(content_.find_first_of(kBlanks, begin), content_.size());
    return content_.substr(begin, at_ - begin);
  }

  template <typename Number>
  Number RequireNumber(std::string_view word) const {
    const auto number = ParseWord<Number>(word);
    if (!number || !std::isfinite(static_cast<double>(*number))) {
      const size_t before = static_cast<size_t>(word.data() - content_.data());
      const auto line = 1 + std::count(content_.begin(), content_.begin() + before, '\n');
      throw InputError({file_.string(), static_cast<int>(line)},
                       fmt::format("got \"{}\"; expected {}", word,
                                   std::is_integral_v<Number> ? "a whole number" : "a number"));
    }
    return *number;
  }

  std::optional<int64_t> LengthInText(const PlyProperty& list) {
    const std::string_view word = NextWord();
    if (word.empty()) return std::nullopt;
    const int64_t length = RequireNumber<int64_t>(word);
    const int64_t largest =
        (int64_t{1} << (8 * list.bytes_of_length - (list.has_signed_length ? 1 : 0))) - 1;
    if (length > largest)
      throw InputError({file_.string()},
                       fmt::format("is malformed: a list \"{}\" has the length {}, but its type "
                                   "ends at {}",
                                   list.name, length, largest));
    return length;
  }

  std::optional<int64_t> LengthInBytes(const PlyProperty& list) {
    const size_t bytes = list.bytes_of_length;
    if (content_.size() - at_ < bytes) return std::nullopt;
    int64_t number = 0;
    for (size_t k = 0; k < bytes; ++k) {
      const size_t byte = header_.is_big_endian ? k : bytes - 1 - k;
      number = number << 8 | static_cast<unsigned char>(content_[at_ + byte]);
    }
    at_ += bytes;
    const int64_t past_largest = int64_t{1} << (8 * bytes - 1);  // of a signed number
    return list.has_signed_length && number >= past_largest ? number - 2 * past_largest : number;
  }

  const std::filesystem::path& file_;
  const std::string_view content_;
  const PlyHeader& header_;
  size_t at_;
};

}  // namespace

const PlyElement* PlyHeader::Find(std::string_view element) const {
  const auto found = std::find_if(elements.begin(), elements.end(),
                                  [&](const PlyElement& one) { return one.name == element; });
  return found != elements.end() ? &*found : nullptr;
}

const PlyProperty* FindProperty(const PlyElement& element, std::string_view name) {
  const auto found = std::find_if(element.properties.begin(), element.properties.end(),
                                  [&](const PlyProperty& one) { return one.name == name; });
  return found != element.properties.end() ? &*found : nullptr;
}

PlyHeader ReadPlyHeader(const std::filesystem::path& file, std::string_view content) {
  return HeaderReader(file, content).Read();
}

void CheckPlyBody(const std::filesystem::path& file, std::string_view content,
                  const PlyHeader& header) {
  BodyReader(file, content, header).Check();
}

}  // namespace lacuna
