#include "scan/frame_list.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <cctype>
#include <regex>
#include <stdexcept>

namespace lacuna {
namespace {

bool IsDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

enum class Decimals { kNo, kYes };

// Splits a text into other characters and runs of digits, in turn: "a12.b" → "a", "12", ".b". With
// decimals, "1.5" is one run, too.
std::vector<std::string> SplitDigits(const std::string& text, Decimals decimals = Decimals::kNo) {
  std::vector<std::string> parts;
  for (size_t at = 0; at < text.size();) {
    size_t end = at;
    while (end < text.size() && IsDigit(text[end]) == IsDigit(text[at])) ++end;
    if (decimals == Decimals::kYes && IsDigit(text[at]) && end + 1 < text.size() &&
        text[end] == '.' && IsDigit(text[end + 1]))
      for (++end; end < text.size() && IsDigit(text[end]);) ++end;
    parts.push_back(text.substr(at, end - at));
    at = end;
  }
  return parts;
}

std::string WithoutLeadingZeros(const std::string& digits) {
  return digits.substr(std::min(digits.find_first_not_of('0'), digits.size() - 1));
}

// Whether the runs of digits behind points in the names of files are decimals: no program that
// writes as many as a number has ends them with 0, as in "1.10", which is then the tenth of a
// count.
bool MayHaveDecimals(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const std::string own = std::filesystem::path(name).filename().string();
    for (const std::string& part : SplitDigits(own, Decimals::kYes)) {
      const size_t point = part.find('.');
      if (!IsDigit(part[0]) || point == std::string::npos) continue;
      if (part.ends_with('0') && part.size() > point + 2) return false;
    }
  }
  return true;
}

// Negative, 0 or positive, as the number that `a` consists of is smaller than `b`, equal or larger.
// Digits behind a point are decimals.
int CompareNumbers(const std::string& a, const std::string& b) {
  const size_t a_point = std::min(a.find('.'), a.size()), b_point = std::min(b.find('.'), b.size());
  const std::string x = WithoutLeadingZeros(a.substr(0, a_point)),
                    y = WithoutLeadingZeros(b.substr(0, b_point));
  if (x.size() != y.size()) return x.size() < y.size() ? -1 : 1;
  return x != y ? x.compare(y) : a.substr(a_point).compare(b.substr(b_point));
}

bool Less(const std::string& a, const std::string& b, Decimals decimals) {
  const std::vector<std::string> left = SplitDigits(a, decimals), right = SplitDigits(b, decimals);
  for (size_t i = 0; i < std::min(left.size(), right.size()); ++i) {
    if (left[i] == right[i]) continue;
    if (IsDigit(left[i][0]) && IsDigit(right[i][0])) {
      const int order = CompareNumbers(left[i], right[i]);
      if (order != 0) return order < 0;
    }
    return left[i] < right[i];
  }
  return left.size() < right.size();
}

// Puts a backslash before each of `special`, so that glob takes it literally.
std::string Escaped(const std::string& text, const std::string& special) {
  std::string escaped;
  for (const char c : text) {
    if (special.find(c) != std::string::npos) escaped += '\\';
    escaped += c;
  }
  return escaped;
}

// The files in `folder`, whose name is taken literally, that match the wildcards * and ?.
std::vector<std::string> ExpandWildcards(const std::filesystem::path& folder,
                                         const std::string& wildcards) {
  glob_t found{};
  std::vector<std::string> names;
  const std::string pattern =
      std::filesystem::path(Escaped(folder.string(), "*?[\\")) / Escaped(wildcards, "[\\");
  if (glob(pattern.c_str(), 0, nullptr, &found) == 0) {
    names.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  }
  globfree(&found);
  SortNaturally(&names);
  return names;
}

}  // namespace

std::vector<std::vector<std::filesystem::path>> OneFilePerFrame(
    const std::vector<std::filesystem::path>& files) {
  std::vector<std::vector<std::filesystem::path>> frames;
  for (const std::filesystem::path& file : files) frames.push_back({file});
  return frames;
}

std::string FillPattern(const std::string& pattern, int number) {
  static const std::regex placeholder("%(0?)([0-9]?)d");
  std::smatch match;
  const bool is_found = std::regex_search(pattern, match, placeholder);
  const std::string behind = is_found ? match.suffix().str() : "";
  if (!is_found || std::regex_search(behind, placeholder)) {
    throw std::invalid_argument(fmt::format(
        "got \"{}\"; expected one placeholder for the number, e.g. frames/points_%02d.ply",
        pattern));
  }
  const int width = match[2].length() > 0 ? std::stoi(match[2]) : 0;
  const std::string digits =
      match[1].length() > 0 ? fmt::format("{:0{}d}", number, width) : fmt::format("{:d}", number);
  return match.prefix().str() + digits + match.suffix().str();
}

void SortNaturally(std::vector<std::string>* names) {
  const Decimals decimals = MayHaveDecimals(*names) ? Decimals::kYes : Decimals::kNo;
  std::sort(names->begin(), names->end(), [decimals](const std::string& a, const std::string& b) {
    return Less(a, b, decimals);
  });
}

std::optional<long> FindMissingNumber(const std::vector<std::string>& sorted_names) {
  if (sorted_names.size() < 3) return std::nullopt;
  const std::vector<std::string> first = SplitDigits(sorted_names[0]);
  std::optional<size_t> varying;
  for (const std::string& name : sorted_names) {
    const std::vector<std::string> parts = SplitDigits(name);
    if (parts.size() != first.size()) return std::nullopt;
    for (size_t i = 0; i < parts.size(); ++i) {
      if (parts[i] == first[i]) continue;
      if (!IsDigit(parts[i][0]) || (varying && *varying != i)) return std::nullopt;
      varying = i;
    }
  }
  if (!varying) return std::nullopt;
  std::vector<long> numbers;
  for (const std::string& name : sorted_names) {
    const std::string digits = SplitDigits(name)[*varying];
    if (digits.size() > 9) return std::nullopt;
    numbers.push_back(std::stol(digits));
  }
  long step = numbers[1] - numbers[0];
  for (size_t i = 1; i < numbers.size(); ++i) step = std::min(step, numbers[i] - numbers[i - 1]);
  if (step <= 0) return std::nullopt;
  // Other numbers, such as times at which the frames were taken, are not evenly spaced.
  std::optional<long> missing;
  size_t steps = 0;
  for (size_t i = 1; i < numbers.size(); ++i) {
    const long difference = numbers[i] - numbers[i - 1];
    if (difference % step != 0) return std::nullopt;
    if (difference == step) ++steps;
    if (difference != step && !missing) missing = numbers[i - 1] + step;
  }
  return 2 * steps >= numbers.size() - 1 ? missing : std::nullopt;
}

std::vector<std::filesystem::path> ReadFrameFiles(const Config& config,
                                                  const std::filesystem::path& data_folder) {
  const std::vector<std::string> given = config.Texts("files");
  const std::string pattern = config.Text("pattern", "");
  if (given.empty() == pattern.empty()) {
    config.Fail("", "expected either files (a list, or a text with * and ?) or pattern with count");
  }
  std::vector<std::filesystem::path> files;
  if (!pattern.empty()) {
    const int first = config.Integer("first", 0, 1'000'000'000, 0);
    const int count = config.Integer("count", 1, 1'000'000);
    for (int i = 0; i < count; ++i) {
      try {
        files.push_back(data_folder / FillPattern(pattern, first + i));
      } catch (const std::invalid_argument& problem) {
        config.Fail("pattern", problem.what());
      }
    }
  } else if (given.size() == 1 && given[0].find_first_of("*?") != std::string::npos) {
    const std::vector<std::string> names = ExpandWildcards(data_folder, given[0]);
    if (names.empty()) {
      config.Fail("files", fmt::format("no file matches {}", (data_folder / given[0]).string()));
    }
    if (const std::optional<long> missing = FindMissingNumber(names)) {
      config.Fail("files", fmt::format("the frame numbered {} is missing among {} … {}; list the "
                                       "files one by one if that is intended",
                                       *missing, names.front(), names.back()));
    }
    files.assign(names.begin(), names.end());
  } else {
    for (const std::string& name : given) files.push_back(data_folder / name);
  }
  for (size_t i = 0; i < files.size(); ++i) {
    if (!std::filesystem::is_regular_file(files[i])) {
      config.Fail(pattern.empty() ? "files" : "pattern",
                  fmt::format("frame {}: there is no file {}", i, files[i].string()));
    }
  }
  return files;
}

}  // namespace lacuna
