// Tracks of named markers, as motion-capture systems record them (marker_files.h reads them).
#ifndef LACUNA_SCAN_MARKER_TRACKS_H_
#define LACUNA_SCAN_MARKER_TRACKS_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
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
  // One m per frame: the weight of each marker, inversely proportional to the variance of its
  // noise, 1 for a typical one. Empty: all are 1.
  std::vector<Eigen::VectorXd> weights = {};
};

// Whether the times of a file are used, so that they have to ascend, or are replaced by others.
enum class FileTimes { kUsed, kReplaced };

// Throws InputError naming the frame of `file` whose time (s) does not follow the one before.
// `rate`: Hz, that the file states; 0 if it states none.
void CheckTimes(const std::filesystem::path& file, const Eigen::VectorXd& times, double rate);

// Makes the names of the markers unique: "a" that occurs again becomes "a (2)". Appends to the
// warnings which names of `file` occur several times.
void NumberRepeatedNames(const std::filesystem::path& file, MarkerTracks* tracks);

// The tracks of the markers `names`, in that order. Throws InputError naming `file` and listing its
// markers when one of them does not exist.
MarkerTracks SelectMarkers(const MarkerTracks& tracks, const std::vector<std::string>& names,
                           const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_SCAN_MARKER_TRACKS_H_
