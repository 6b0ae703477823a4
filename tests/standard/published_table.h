// A table of published values in CSV: a header, then rows with text and numbers.
#ifndef LACUNA_STANDARD_PUBLISHED_TABLE_H_
#define LACUNA_STANDARD_PUBLISHED_TABLE_H_

#include <filesystem>
#include <string>
#include <vector>

namespace lacuna {

struct PublishedTable {
  std::filesystem::path file;
  std::vector<std::string> header;             // names of the columns
  std::vector<std::vector<std::string>> rows;  // without the header

  // Throws InputError if the file cannot be read.
  static PublishedTable Load(const std::filesystem::path& file);

  // The number in a row, counted from 1. Throws InputError if there is no such row or column, or if
  // the entry is not a number.
  double Number(int row, const std::string& column) const;
};

}  // namespace lacuna

#endif  // LACUNA_STANDARD_PUBLISHED_TABLE_H_
