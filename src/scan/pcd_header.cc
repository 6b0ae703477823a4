#include "scan/pcd_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/parsed_word.h"
#include "scan/table_numbers.h"
#include "scan/table_text.h"

namespace lacuna {
namespace {

constexpr size_t kMostPoints = size_t{1} << 31;  // PCL counts in 32 bits
constexpr double kValuesPerByte = 300;           // no LZF stream packs more

class HeaderReader {
 public:
  HeaderReader(const std::filesystem::path& file, std::string_view content)
      : file_(file), content_(content) {}

  PcdHeader Read() {
    while (data_.empty()) {
      const size_t end = content_.find('\n', at_);
      if (end == std::string_view::npos)
        throw InputError({file_.string()}, "is not a PCD file or ends within its header");
      ++line_;
      const std::string_view line = Trim(content_.substr(at_, end - at_));
      if (line.empty() && end > at_) Fail("has a line of spaces in its header");
      at_ = end + 1;
      if (!line.empty() && line[0] != '#') Take(SplitFields(line, ' '));
    }
    Complete();
    return {data_ == "ascii", at_};
  }

 private:
  [[noreturn]] void Fail(const std::string& message) const {
    throw InputError({file_.string(), line_}, message);
  }

  size_t CountIn(std::string_view word) const {
    const auto count = ParseWord<size_t>(word);
    if (!count || *count > kMostPoints) Fail(fmt::format("got \"{}\"; expected a count", word));
    return *count;
  }

  void Take(std::vector<std::string_view> words) {
    const std::string_view key = words[0];
    words.erase(words.begin());
    constexpr std::array kKeys{"VERSION", "FIELDS", "COLUMNS",   "SIZE",   "TYPE", "COUNT",
                               "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
    if (std::find(kKeys.begin(), kKeys.end(), key) == kKeys.end())
      Fail(fmt::format("is not a PCD file, or its header is damaged: got \"{}\"", key));
    if (words.empty()) Fail(fmt::format("\"{}\" has no value", key));
    if (std::find(taken_.begin(), taken_.end(), key) != taken_.end())
      Fail(fmt::format("has a second line {}", key));
    taken_.push_back(key);
    if (key == "FIELDS" || key == "COLUMNS") {
      if (!fields_.empty()) Fail("names the fields a second time");
      fields_.assign(words.begin(), words.end());
      for (const std::string& field : fields_)
        if (!std::all_of(field.begin(), field.end(), [](char c) { return c > ' ' && c <= '~'; }))
          Fail("the name of a field holds characters that cannot be printed");
      return;
    }
    const bool is_per_field = key == "SIZE" || key == "TYPE" || key == "COUNT";
    if (is_per_field && words.size() != fields_.size())
      Fail(fmt::format("{} has {} entries for {} fields", key, words.size(), fields_.size()));
    if (key == "SIZE") {
      sizes_.clear();
      for (const std::string_view word : words) {
        sizes_.push_back(CountIn(word));
        if (sizes_.back() != 1 && sizes_.back() != 2 && sizes_.back() != 4 && sizes_.back() != 8)
          Fail(fmt::format("got \"{}\"; expected a size of 1, 2, 4 or 8 bytes", word));
      }
    } else if (key == "TYPE") {
      types_.clear();
      for (const std::string_view word : words) {
        if (word != "F" && word != "I" && word != "U")
          Fail(fmt::format("got \"{}\"; expected F, I or U", word));
        types_.push_back(word[0]);
      }
    } else if (key == "COUNT") {
      counts_.clear();
      for (const std::string_view word : words) {
        counts_.push_back(CountIn(word));
        if (counts_.back() == 0) Fail("got 0; a field has at least one value");
      }
    } else if (key == "WIDTH") {
      width_ = CountIn(words[0]);
    } else if (key == "HEIGHT") {
      height_ = CountIn(words[0]);
    } else if (key == "POINTS") {
      points_ = CountIn(words[0]);
    } else if (key == "DATA") {
      if (words[0] != "ascii" && words[0] != "binary" && words[0] != "binary_compressed")
        Fail(fmt::format("got \"{}\"; expected ascii, binary or binary_compressed", words[0]));
      data_ = words[0];
    } else if (key == "VIEWPOINT") {
      if (words.size() != 7) Fail(fmt::format("VIEWPOINT has {} of 7 numbers", words.size()));
      for (const std::string_view word : words)
        if (!ParseNumber(word)) Fail(fmt::format("got \"{}\"; expected a number", word));
    }
  }

  void Complete() {
    const auto fail = [&](const std::string& message) {
      throw InputError({file_.string()}, message);
    };
    if (fields_.empty()) fail("has a PCD header without FIELDS");
    if (sizes_.empty() || types_.empty()) fail("has a PCD header without SIZE or TYPE");
    for (size_t k = 0; k < sizes_.size(); ++k)
      if (types_[k] == 'F' && sizes_[k] < 4)
        fail(fmt::format("holds \"{}\" as numbers of {} bytes; floating-point numbers have 4 or 8",
                         fields_[k], sizes_[k]));
    if (counts_.empty()) counts_.assign(fields_.size(), 1);
    if (!width_) fail("has a PCD header without WIDTH");
    const size_t points = points_.value_or(*width_ * height_);
    if (points != *width_ * height_)
      fail(fmt::format("announces {} points and an image of {} × {}", points, *width_, height_));
    // In text, a value takes at least one byte.
    double values = 0, bytes = 0;
    for (size_t k = 0; k < sizes_.size(); ++k) {
      values += static_cast<double>(counts_[k]);
      bytes += static_cast<double>(counts_[k] * sizes_[k]);
    }
    const double of_file = static_cast<double>(content_.size() - at_);
    const double needed = data_ == "ascii"    ? values
                          : data_ == "binary" ? bytes
                                              : bytes / kValuesPerByte;
    if (static_cast<double>(points) * needed > of_file)
      fail(fmt::format("is truncated or malformed: its header announces {} points", points));
    if (data_ != "binary_compressed") return;
    // The body begins with the numbers of its bytes, compressed and not.
    uint32_t numbers[2] = {};
    if (content_.size() - at_ < sizeof(numbers)) fail("ends before its points");
    std::memcpy(numbers, content_.data() + at_, sizeof(numbers));
    if (numbers[0] > content_.size() - at_ - sizeof(numbers) ||
        static_cast<double>(numbers[1]) != static_cast<double>(points) * bytes)
      fail(
          fmt::format("is truncated or malformed: {} compressed bytes stand for {}, {} points of "
                      "{} bytes are announced",
                      numbers[0], numbers[1], points, bytes));
  }

  const std::filesystem::path& file_;
  const std::string_view content_;
  size_t at_ = 0;
  int line_ = 0;
  std::vector<std::string_view> taken_;  // keys so far
  std::string_view data_;                // the kind of the body; empty until its line is read
  std::vector<std::string> fields_;
  std::vector<char> types_;  // F, I or U
  std::vector<size_t> sizes_, counts_;
  std::optional<size_t> width_, points_;
  size_t height_ = 1;
};

}  // namespace

PcdHeader ReadPcdHeader(const std::filesystem::path& file, std::string_view content) {
  return HeaderReader(file, content).Read();
}

}  // namespace lacuna
