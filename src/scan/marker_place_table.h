// Reads where the markers sit on the undeformed object from a table of text.
#ifndef LACUNA_SCAN_MARKER_PLACE_TABLE_H_
#define LACUNA_SCAN_MARKER_PLACE_TABLE_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace lacuna {

struct MarkerPlace {
  std::string name;
  Eigen::Vector3d position;  // in the unit of the file; may be NaN or infinite
  int line = 0;              // of the file, from 1
};

// Reads a table with one marker per row and the columns `name`, `x`, `y` and `z`, in any order and
// with letters of any case; other columns are ignored. Delimiters, quotes, comments and decimal
// commas are those of delimited_table.h. Throws InputError at file:line:column when the file is
// absent or empty, one of the columns is missing or there twice, a row has another number of
// entries than the first line, or a coordinate is not a number or may have a separator of
// thousands.
std::vector<MarkerPlace> ReadMarkerPlaces(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_SCAN_MARKER_PLACE_TABLE_H_
