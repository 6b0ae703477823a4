// Where the data files of a recording lie and in which unit of length their numbers are.
//
// This is the part of a recording that the readers of its frames, grips and forces need. They get
// it in place of the whole Recording, which is assembled from their results.
#ifndef LACUNA_SCAN_DATA_LOCATION_H_
#define LACUNA_SCAN_DATA_LOCATION_H_

#include <filesystem>
#include <string>
#include <vector>

namespace lacuna {

struct DataLocation {
  std::filesystem::path folder;  // file names in recording.yaml are relative to it
  std::string length_unit;       // unit of the lengths in the files, e.g. "mm"; see LengthOf()
};

// What the frames say about other measurements of a recording.
struct FrameData {
  std::vector<double> times;                   // s, of all frames in the files
  std::vector<std::filesystem::path> headers;  // one file per frame whose header (table_header.h)
                                               // may have values; empty for other files
};

}  // namespace lacuna

#endif  // LACUNA_SCAN_DATA_LOCATION_H_
