// Where the rows of a text table begin, and what separates their entries.
#ifndef LACUNA_SCAN_TABLE_LAYOUT_H_
#define LACUNA_SCAN_TABLE_LAYOUT_H_

#include <cstddef>
#include <optional>
#include <string_view>

namespace lacuna {

// The delimiter that a line such as "sep=;" declares, with which spreadsheet programs begin a file.
std::optional<char> DeclaredDelimiter(std::string_view line);

// The delimiter of a table of which `line` is the first line and `rest` what follows it (the rules
// are those of delimited_table.h).
char FindDelimiter(std::string_view line, std::string_view rest);

// The length of the title above the names of the columns, with which `text` begins; 0: it has none.
size_t LengthOfTitle(std::string_view text);

// Whether `line` is the number of the points in the rows below it, which `rest` begins with.
bool IsCount(std::string_view line, std::string_view rest);

}  // namespace lacuna

#endif  // LACUNA_SCAN_TABLE_LAYOUT_H_
