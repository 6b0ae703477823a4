#include "faults/folder_content.h"

#include <set>

#include "core/hash.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

constexpr char kDigits[] = "+-.0123456789e";

bool IsLock(const fs::path& path) {
  static const std::set<std::string> names{".lock", ".claimed", ".planning", "claimed"};
  return names.contains(path.filename().string());
}

// Removes the number, if there is any, that begins at `begin` or after spaces there.
void RemoveNumber(size_t begin, std::string* text) {
  begin = text->find_first_not_of(' ', begin);
  if (begin == std::string::npos) return;
  text->erase(begin, text->find_first_not_of(kDigits, begin) - begin);
}

}  // namespace

std::string WithoutTimes(std::string text, const fs::path& file) {
  constexpr std::string_view kKey = "seconds\":";
  for (size_t at = text.find(kKey); at != std::string::npos; at = text.find(kKey, at + 1))
    RemoveNumber(at + kKey.size(), &text);
  if (file.filename() != "table1.txt") return text;
  // "49  6 (0)  0.06": evaluations, failures in brackets, seconds per evaluation.
  for (size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', end + 1)) {
    const size_t before = text.find_last_not_of(kDigits, end - 1);
    if (before == std::string::npos || before + 1 >= end || text[before] != ' ') continue;
    const size_t word = text.find_last_not_of(' ', before);
    if (word == std::string::npos || text[word] != ')') continue;
    text.erase(word + 1, end - word - 1);
    end = word + 1;
  }
  return text;
}

std::map<std::string, std::string> ContentOf(const fs::path& folder) {
  static const std::set<std::string> timed{".json", ".jsonl", ".html", ".txt"};
  std::map<std::string, std::string> content;
  if (!fs::exists(folder)) return content;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path& file = entry.path();
    if (!entry.is_regular_file() || IsLock(file) || file.filename() == "log.txt") continue;
    content[file.lexically_relative(folder).generic_string()] =
        timed.contains(file.extension().string()) ? HashBytes(WithoutTimes(FileContent(file), file))
                                                  : HashFile(file);
  }
  return content;
}

std::string Difference(const std::map<std::string, std::string>& expected,
                       const std::map<std::string, std::string>& found) {
  for (const auto& [name, hash] : expected) {
    const auto other = found.find(name);
    if (other == found.end()) return name + " is missing";
    if (other->second != hash) return name + " differs";
  }
  for (const auto& [name, hash] : found)
    if (!expected.contains(name)) return name + " is left over";
  return "";
}

int CountHidden(const fs::path& folder) {
  int count = 0;
  if (!fs::exists(folder)) return 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    count += entry.path().filename().string().starts_with(".") && !IsLock(entry.path());
  return count;
}

}  // namespace lacuna
