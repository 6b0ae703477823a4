// Tracks of named markers, as motion capture records them: CSV, TRC and C3D.
#ifndef LACUNA_SCAN_MARKER_TRACKS_H_
#define LACUNA_SCAN_MARKER_TRACKS_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace lacuna {

struct MarkerTracks {
  std::vector<std::string> names;           // m
  Eigen::VectorXd times;                    // f, s, from the file; empty where it tells none
  std::vector<Eigen::Matrix3Xd> positions;  // f matrices 3 × m, in the file's length unit;
                                            // NaN where a marker was not seen
  std::string length_unit;                  // as the file says ("mm"); empty where it does not
};

// How a CSV names its columns. A star stands for the marker's name: "*_x" finds tip1_x, base1_x.
struct MarkerColumns {
  std::string time;  // column with the time in seconds; empty: the file has none
  std::string x = "*_x", y = "*_y", z = "*_z";
};

// Reads .trc, .c3d, or a CSV with a header. Throws InputError naming the file (and line) when it is
// absent, truncated, malformed, or its counts contradict one another.
MarkerTracks ReadMarkerTracks(const std::filesystem::path& file, const MarkerColumns& columns);
MarkerTracks ReadMarkerCsv(const std::filesystem::path& file, const MarkerColumns& columns);
MarkerTracks ReadTrc(const std::filesystem::path& file);

// The 3-D points of a C3D file (c3d.org user guide): integer or floating-point data of Intel, DEC
// and SGI/MIPS processors. A point with a negative residual was not seen.
MarkerTracks ReadC3d(const std::filesystem::path& file);

// Only the markers `names`, in that order. Throws InputError listing the markers there are.
MarkerTracks SelectMarkers(const MarkerTracks& tracks, const std::vector<std::string>& names,
                           const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_SCAN_MARKER_TRACKS_H_
