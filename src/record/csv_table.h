// Tables of numbers with named columns, for people, spreadsheets and plotting programs.
#ifndef LACUNA_RECORD_CSV_TABLE_H_
#define LACUNA_RECORD_CSV_TABLE_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace lacuna {

struct CsvColumn {
  std::string name;  // with its unit: "time_s"
  Eigen::VectorXd values;
};
using CsvTable = std::vector<CsvColumn>;

// Written atomically; each number in the shortest form that reads back the same, NaN as "nan".
// Columns of unequal length, and names that are empty, repeated or hold a comma, quote or line
// break, are a mistake of the program (CHECK).
void SaveCsv(const CsvTable& table, const std::filesystem::path& file);

// Reads what SaveCsv wrote. Throws InputError with file:line when a row has another number of
// fields than the header, or a field is no number.
CsvTable LoadCsv(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_RECORD_CSV_TABLE_H_
