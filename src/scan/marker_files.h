// Reads the files in which motion-capture systems record the tracks of markers.
#ifndef LACUNA_SCAN_MARKER_FILES_H_
#define LACUNA_SCAN_MARKER_FILES_H_

#include <filesystem>
#include <string>

#include "scan/marker_tracks.h"

namespace lacuna {

// How a CSV names its columns. A star represents the marker's name: "*_x" finds tip1_x, base1_x,
// and tip1_X where no name fits exactly.
struct MarkerColumns {
  std::string time;      // column with the time; empty: the file has none
  double time_unit = 1;  // s, of that column
  std::string x = "*_x", y = "*_y", z = "*_z";
};

// Reads a file in the format of its extension: .trc, .c3d, or else a table of a motion-capture
// program (capture_tables.h) or a CSV with a header. `columns` applies to the latter only. Throws
// InputError naming the file (and line) when it is absent, truncated or malformed, when its counts
// contradict one another, when two columns of a CSV have the same name, its coordinates have
// different units or its time has another unit than `time_unit`, or when times that are used do not
// ascend. Names that occur several times are numbered in the other formats, with a warning.
MarkerTracks ReadMarkerTracks(const std::filesystem::path& file, const MarkerColumns& columns,
                              FileTimes use = FileTimes::kUsed);
MarkerTracks ReadMarkerCsv(const std::filesystem::path& file, const MarkerColumns& columns,
                           FileTimes use = FileTimes::kUsed);
MarkerTracks ReadTrc(const std::filesystem::path& file, FileTimes use = FileTimes::kUsed);

// Reads the 3-D points of a C3D file (The C3D File Format User Guide, https://www.c3d.org),
// integers or floating-point numbers written on Intel, DEC or SGI/MIPS processors. A point with a
// negative residual was not seen. Times start at 0; their rate is that of the header, or else
// POINT:RATE, with a warning where the two differ. Without either, times that are used are an
// error. Where the 16-bit frame numbers of the header do not suffice, the parameters POINT:FRAMES,
// POINT:LONG_FRAMES or TRIAL:ACTUAL_START_FIELD and ACTUAL_END_FIELD give the number of frames. A
// file that has room for more frames than these and its header say leads to a warning.
MarkerTracks ReadC3d(const std::filesystem::path& file, FileTimes use = FileTimes::kUsed);

}  // namespace lacuna

#endif  // LACUNA_SCAN_MARKER_FILES_H_
