// Tables of numbers in text files: CSV, TSV and columns separated by blanks.
#ifndef LACUNA_SCAN_DELIMITED_TABLE_H_
#define LACUNA_SCAN_DELIMITED_TABLE_H_

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna {

// Lines starting with '#' and empty lines are skipped. The first line is the header when one of
// its entries is neither a number nor empty. The delimiter is the first of ';' ',' tab found in the
// first line, else blanks.
struct DelimitedTable {
  std::filesystem::path file;
  std::vector<std::string> header;  // empty without one
  Eigen::MatrixXd values;           // rows × columns; NaN for an empty entry and for "nan"
  std::vector<int> line;            // line of the file of each row, from 1
};

// Throws InputError at file:line:column when the file is absent or empty, an entry is not a number
// or a row has another number of entries than the first.
DelimitedTable ReadDelimitedTable(const std::filesystem::path& file);

// The column called `name`, or, where no header says so, the column number `name` counted from 1.
std::optional<Eigen::Index> FindColumn(const DelimitedTable& table, const std::string& name);
// The same, required: the InputError lists the columns there are.
Eigen::Index RequireColumn(const DelimitedTable& table, const std::string& name);

// `line` cut at the delimiter (' ' stands for any run of blanks), each entry without blanks around.
std::vector<std::string_view> SplitFields(std::string_view line, char delimiter);

// The number that fills `text` wholly (NaN for an empty text and for "nan"); none otherwise.
std::optional<double> ParseNumber(std::string_view text);

// The whole of a file with measurements. Throws InputError when it cannot be read or is empty.
std::string ReadFilledFile(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_SCAN_DELIMITED_TABLE_H_
