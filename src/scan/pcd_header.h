// The header of a PCD file of the Point Cloud Library.
//
// PCL trusts the header: other numbers of sizes than of fields, or counts that do not fit together,
// make it leave its memory. A header that is read here is known to be sound.
#ifndef LACUNA_SCAN_PCD_HEADER_H_
#define LACUNA_SCAN_PCD_HEADER_H_

#include <filesystem>
#include <string_view>

namespace lacuna {

struct PcdHeader {
  bool is_text = false;
  size_t body = 0;  // position of the first byte after the header
};

// `content`: the whole file. Throws InputError with the file and the line for a header that is
// incomplete, holds an unknown word or numbers that do not fit together, or announces more values
// than the file can hold or its compressed body says.
PcdHeader ReadPcdHeader(const std::filesystem::path& file, std::string_view content);

}  // namespace lacuna

#endif  // LACUNA_SCAN_PCD_HEADER_H_
