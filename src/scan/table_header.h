// Values that stand above the rows of a text table, in its comments.
//
// ARAMIS writes what its analogue inputs measured at the time of the image there:
//   # force     : value_element : 14985.6
// Lines of the form "# name: value" and "# name = value" are read likewise, and the stage of GOM
// software (kStageHeader): index and relative_time.
#ifndef LACUNA_SCAN_TABLE_HEADER_H_
#define LACUNA_SCAN_TABLE_HEADER_H_

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna {

struct HeaderValue {
  double value = 0;
  std::string unit;  // behind the number, as in "12.5 N" or "12.5 [N]"; empty: none is given
};

// The values in the comments above the first row, by name; of a name that occurs twice, the first.
// Comments begin with # or ***. Numbers have a decimal point or a decimal comma. Values that are
// not numbers, or may have a separator of thousands, are left out.
std::map<std::string, HeaderValue> HeaderValuesIn(std::string_view content);

// Reads the comments of a text file. Throws InputError when it cannot be read.
std::map<std::string, HeaderValue> ReadHeaderValues(const std::filesystem::path& file);

// The value `name` of each of `files` in multiples of `unit`, of which the name is `unit_name`.
// Throws InputError, naming the file, when it has no such value (listing those that it has), or one
// that is not finite or in another unit.
std::vector<double> HeaderValuesOf(const std::vector<std::filesystem::path>& files,
                                   const std::string& name, double unit,
                                   const std::string& unit_name);

}  // namespace lacuna

#endif  // LACUNA_SCAN_TABLE_HEADER_H_
