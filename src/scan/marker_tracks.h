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

// Sets the times of the tracks to `times` (s, of `file`, which states `rate` in Hz; 0: none). Times
// that are used must ascend: throws InputError naming the frame whose time does not follow the one
// before, and warns where they contradict the rate. Times that are replaced are left out if they do
// not ascend, and serve for a comparison only (ReadFrameTimes).
void SetTimes(const std::filesystem::path& file, const Eigen::VectorXd& times, double rate,
              FileTimes use, MarkerTracks* tracks);

// Whether `a` and `b` differ by more than 2 %, or by more than one of `count` intervals: a rounded
// time may be off by one.
bool RatesDiffer(double a, double b, size_t count);

// Makes the names of the markers unique: "a" that occurs again becomes "a (2)". Appends to the
// warnings which names of `file` occur several times.
void NumberRepeatedNames(const std::filesystem::path& file, MarkerTracks* tracks);

// The tracks of the markers `names`, in that order. Throws InputError naming `file` and listing its
// markers when one of them does not exist.
MarkerTracks SelectMarkers(const MarkerTracks& tracks, const std::vector<std::string>& names,
                           const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_SCAN_MARKER_TRACKS_H_
