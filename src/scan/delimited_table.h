// Reads tables of numbers from text files: CSV, TSV and columns separated by blanks.
#ifndef LACUNA_SCAN_DELIMITED_TABLE_H_
#define LACUNA_SCAN_DELIMITED_TABLE_H_

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna {

// Lines starting with '#', empty lines and, above the table, lines starting with "***" are skipped,
// and the stage of GOM software, a table of its own (kStageHeader). Rows at the end of the table
// whose entries are all empty, as spreadsheet programs leave them, are no rows.
// A title is skipped, too: lines without delimiter, the first of which is no row of numbers, above
// a line of names with delimiters; and a line that holds the number of the rows below it alone. The
// first line is the header when one of its entries is neither a number nor empty; "//" in front of
// it is no part of a name. The line below it may hold units, as "(s)" or "s", or a second name:
// where names are missing or repeated in the first, as in ",m0,,,m1,," above "t,x,y,z,x,y,z", the
// name of a column is that of its group and its own, m0_x. The delimiter is the one that a first
// line "sep=;" declares, and otherwise the first of ';', ',' and tab that occurs in the first line
// outside of quotes, or else any run of blanks; a tab comes first where it alone divides the line
// of names and the row below into as many entries. Where the delimiter is not ',', and in quotes,
// numbers may have a decimal comma (DecimalCommas). Two quotes in the quotes of a name stand for
// one. A byte order mark is not part of the first entry (ReadTextFile).
inline constexpr std::string_view kStageHeader = "stage;index;relative_time;date";

struct DelimitedTable {
  std::filesystem::path file;
  std::vector<std::string> header;  // names of the columns; empty if the file has none
  std::vector<std::string> units;  // in the line below them, without brackets; empty if it has none
  Eigen::MatrixXd values;          // rows × columns; NaN for an empty entry and for "nan"
  std::vector<int> line;           // line of the file of each row, from 1
  // Entries of the last comment above the first row, if it has as many as a row; empty if not.
  std::vector<std::string> commented_header;
  std::vector<std::string> comments;  // above the first row, without their marks
  std::vector<std::string> notes;     // doubts about the first line, each of which begins with the
                                      // name of the file
};

// Throws InputError at file:line:column when the file is absent or empty, an entry is not a number
// or may have a separator of thousands, or a row does not have as many entries as the first.
DelimitedTable ReadDelimitedTable(const std::filesystem::path& file);

// The column called `name` or, when the header has no such name, the column with the number `name`
// counted from 1, or else the only column whose name differs in the case of its letters alone.
// Returns its index from 0, or nothing when there is no such column. Throws InputError naming the
// table when several columns have this name.
std::optional<Eigen::Index> FindColumn(const DelimitedTable& table, const std::string& name);

// The same, but throws InputError listing the columns of the table when there is no such column.
Eigen::Index RequireColumn(const DelimitedTable& table, const std::string& name);

// The delimiter that a line such as "sep=;" declares, with which spreadsheet programs begin a file.
std::optional<char> DeclaredDelimiter(std::string_view line);

// Whether two letters are the same, with regard to their case or without.
bool IsSameLetter(char a, char b, bool case_counts);

// Without blanks, tabs and line ends at both ends.
std::string_view Trim(std::string_view text);

// The lines of `content` without their ends, which may be those of Windows.
std::vector<std::string_view> SplitLines(std::string_view content);

// Cuts `line` at the delimiter (' ' stands for any run of blanks) and trims blanks around each
// entry. A delimiter between quotes does not count. The entries refer to the memory of `line`.
std::vector<std::string_view> SplitFields(std::string_view line, char delimiter);

// The content of a file: all of its bytes, or its text (ReadTextFile). Throw InputError when it
// cannot be read or is empty.
std::string ReadFilledFile(const std::filesystem::path& file);
std::string ReadFilledText(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_SCAN_DELIMITED_TABLE_H_
