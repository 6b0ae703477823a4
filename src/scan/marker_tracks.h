// Tracks of named markers, as motion-capture systems record them in CSV, TRC and C3D files.
#ifndef LACUNA_SCAN_MARKER_TRACKS_H_
#define LACUNA_SCAN_MARKER_TRACKS_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna {

// Named points in f frames.
struct MarkerTracks {
  std::vector<std::string> names;           // m
  Eigen::VectorXd times;                    // f, s; empty when the file has none
  std::vector<Eigen::Matrix3Xd> positions;  // f matrices 3 × m, in the file's length unit;
                                            // NaN where a marker was not seen
  std::string length_unit;                  // unit stated in the file ("mm"); empty if none
  std::vector<std::string> warnings;        // doubts about the file, which they name
};

// Points of a recording that are identified by name, in its frames and in SI units.
struct Markers {
  std::vector<std::string> names;           // m
  Eigen::Matrix3Xd places;                  // 3 × m, m, on the undeformed object; NaN if unknown
  std::vector<Eigen::Matrix3Xd> positions;  // one 3 × m per frame, m, world frame; NaN: not seen
};

// How a CSV names its columns. A star represents the marker's name: "*_x" finds tip1_x, base1_x.
struct MarkerColumns {
  std::string time;  // column with the time in seconds; empty: the file has none
  std::string x = "*_x", y = "*_y", z = "*_z";
};

// Whether the times of a file are used, so that they have to ascend, or are replaced by others.
enum class FileTimes { kUsed, kReplaced };

// Reads a file in the format of its extension: .trc, .c3d, or else a table of a motion-capture
// program (capture_tables.h) or a CSV with a header. `columns` applies to the latter only. Throws
// InputError naming the file (and line) when it is absent, truncated or malformed, when its counts
// contradict one another, or when times that are used do not ascend. Times that are replaced are
// left out.
MarkerTracks ReadMarkerTracks(const std::filesystem::path& file, const MarkerColumns& columns,
                              FileTimes times = FileTimes::kUsed);
MarkerTracks ReadMarkerCsv(const std::filesystem::path& file, const MarkerColumns& columns,
                           FileTimes times = FileTimes::kUsed);
MarkerTracks ReadTrc(const std::filesystem::path& file, FileTimes times = FileTimes::kUsed);

// Reads the 3-D points of a C3D file (The C3D File Format User Guide, https://www.c3d.org),
// integers or floating-point numbers written on Intel, DEC or SGI/MIPS processors. A point with a
// negative residual was not seen. Times start at 0. Where the 16-bit frame numbers of the header
// do not suffice, the parameters POINT:FRAMES, POINT:LONG_FRAMES or TRIAL:ACTUAL_START_FIELD and
// ACTUAL_END_FIELD give the number of frames; without them a file that seems to hold more frames
// than its header says leads to a warning.
MarkerTracks ReadC3d(const std::filesystem::path& file);

// Throws InputError naming the frame of `file` whose time (s) does not follow the one before.
// `rate`: Hz, that the file states; 0 if it states none.
void CheckTimes(const std::filesystem::path& file, const Eigen::VectorXd& times, double rate);

// The lines of `content` without their ends, which may be those of Windows.
std::vector<std::string_view> SplitLines(std::string_view content);

// The tracks of the markers `names`, in that order. Throws InputError naming `file` and listing its
// markers when one of them does not exist.
MarkerTracks SelectMarkers(const MarkerTracks& tracks, const std::vector<std::string>& names,
                           const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_SCAN_MARKER_TRACKS_H_
