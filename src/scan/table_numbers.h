// The numbers in tables of text, with decimal points or commas.
#ifndef LACUNA_SCAN_TABLE_NUMBERS_H_
#define LACUNA_SCAN_TABLE_NUMBERS_H_

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace lacuna {

// The number that `text` consists of (NaN for an empty text and for "nan"), or nothing when it is
// not a number.
std::optional<double> ParseNumber(std::string_view text);

// ParseNumber() for a number with a decimal point or a decimal comma, and NaN for what tables have
// in the place of a value that is missing (IsMissing).
std::optional<double> ParseDecimal(std::string_view text);

// Whether an entry says that there is no value: "NA", "N/A", "#N/A", "NULL" or "None" in any case,
// "-" or "--", or what C programs of Windows print for NaN, such as "1.#QNAN".
bool IsMissing(std::string_view text);

// Whether the comma in a number may as well separate thousands: in "1,005", but not in "0,500" or
// "1,5".
bool MayBeThousands(std::string_view text);

// Whether the commas in the numbers of one file are decimal ones. "1,005" may also be a thousand
// and five. Its comma is taken for a decimal one if no number of the file has a decimal point and,
// where ',' is also the delimiter, another number has a comma that cannot separate thousands, such
// as "1,5".
class DecimalCommas {
 public:
  // `line` and `column` of the entry in the file, from 1.
  void Add(std::string_view entry, int line, int column);
  // Throws InputError at the first entry in doubt, with both of its meanings.
  void RefuseThousands(const std::filesystem::path& file, char delimiter) const;

 private:
  bool has_point_ = false, is_certain_ = false;
  std::string doubtful_;  // the first such entry; empty: there is none
  int line_ = 0, column_ = 0;
};

}  // namespace lacuna

#endif  // LACUNA_SCAN_TABLE_NUMBERS_H_
