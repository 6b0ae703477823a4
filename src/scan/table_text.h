// The text of tables: lines, and the entries in them.
#ifndef LACUNA_SCAN_TABLE_TEXT_H_
#define LACUNA_SCAN_TABLE_TEXT_H_

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna {

// Whether two letters are the same, with regard to their case or without.
bool IsSameLetter(char a, char b, bool case_counts);

// The text without blanks, tabs and line ends at both ends.
std::string_view Trim(std::string_view text);

// The lines of `content` without their ends, which may be those of Windows.
std::vector<std::string_view> SplitLines(std::string_view content);

// Cuts `line` at the delimiter (' ' stands for any run of blanks) and trims blanks around each
// entry. A delimiter between quotes does not count. The entries refer to the memory of `line`.
std::vector<std::string_view> SplitFields(std::string_view line, char delimiter);

// Whether a row consists of empty entries only.
bool AreEmpty(const std::vector<std::string_view>& fields);

// Whether all entries are numbers or stand for missing ones (ParseDecimal in table_numbers.h).
bool AreNumbers(const std::vector<std::string_view>& fields);

// The content of a file: all of its bytes, or its text (ReadTextFile). Throw InputError when it
// cannot be read or is empty.
std::string ReadFilledFile(const std::filesystem::path& file);
std::string ReadFilledText(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_SCAN_TABLE_TEXT_H_
