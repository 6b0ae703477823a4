// Tables of numbers with named columns as CSV files, for spreadsheets and plotting programs.
#ifndef LACUNA_RECORD_CSV_TABLE_H_
#define LACUNA_RECORD_CSV_TABLE_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace lacuna {

struct CsvColumn {
  std::string name;  // ends with the SI unit: "time_s"
  Eigen::VectorXd values;
};
using CsvTable = std::vector<CsvColumn>;

// Writes the table atomically. Each number gets the shortest form that is read back as the same
// double; NaN is written as "nan". Throws InputError if the file cannot be written. Columns of
// unequal length, and names that are empty, repeated or contain a comma, quote or line break, are
// programming errors (CHECK).
void WriteCsv(const CsvTable& table, const std::filesystem::path& file);

// Reads a file written by WriteCsv. Throws InputError with file:line if a row has another number of
// fields than the header or if a field is not a number.
CsvTable ReadCsv(const std::filesystem::path& file);

// The values of the column with this name; nullptr if there is none.
const Eigen::VectorXd* FindColumn(const CsvTable& table, const std::string& name);

// FindColumn() for a column that must be there. Throws InputError, which names the table's `file`,
// if there is none.
const Eigen::VectorXd& ColumnOf(const CsvTable& table, const std::string& name,
                                const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_RECORD_CSV_TABLE_H_
