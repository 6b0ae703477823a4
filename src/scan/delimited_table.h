// Reads tables of numbers from text files: CSV, TSV and columns separated by blanks.
//
// What is skipped:
// - lines that begin with '#', and empty lines;
// - above the table, lines that begin with "***", as in files of DICe;
// - the stage of GOM software (kStageHeader) and the line below it;
// - a title: lines without delimiter, the first of which is no row of numbers, above a line of
//   names with delimiters;
// - a line that holds the number of the rows below it alone;
// - rows at the end of the table whose entries are all empty, as spreadsheet programs leave them.
//
// The names of the columns:
// - The first line is the header when one of its entries is neither a number nor empty. "//" in
//   front of it is no part of a name. Two quotes in the quotes of a name stand for one. A byte
//   order mark is not part of the first entry (ReadTextFile).
// - The line below it may hold units, as "(s)" or "s", or a second name: where names are missing or
//   repeated in the first, as in ",m0,,,m1,," above "t,x,y,z,x,y,z", the name of a column is that
//   of its group and its own, m0_x.
//
// The delimiter is, in this order:
// - the one that a first line "sep=;" declares;
// - the tab where it alone divides the line of names and the row below into as many entries;
// - the first of ';', ',' and tab that occurs in the first line outside of quotes;
// - any run of blanks.
//
// Where the delimiter is not ',', and in quotes, numbers may have a decimal comma (DecimalCommas).
#ifndef LACUNA_SCAN_DELIMITED_TABLE_H_
#define LACUNA_SCAN_DELIMITED_TABLE_H_

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna {

// The header of the stage in tables of GOM software, a table of its own above the other one.
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
// or may have a separator of thousands, a row does not have as many entries as the first, or lines
// of a summary follow the last row.
DelimitedTable ReadDelimitedTable(const std::filesystem::path& file);

// The column called `name` or, when the header has no such name, the column with the number `name`
// counted from 1, or else the only column whose name differs in the case of its letters alone.
// Returns its index from 0, or nothing when there is no such column. Throws InputError naming the
// table when several columns have this name.
std::optional<Eigen::Index> FindColumn(const DelimitedTable& table, const std::string& name);

// FindColumn() for a column that must be there. Throws InputError listing the columns of the table
// when there is none.
Eigen::Index RequireColumn(const DelimitedTable& table, const std::string& name);

}  // namespace lacuna

#endif  // LACUNA_SCAN_DELIMITED_TABLE_H_
