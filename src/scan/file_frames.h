// What the kinds of frames that come from one or several files per frame have in common.
//
// A struct derived from FileFrames is a kind of frames (frame_source.h); the functions here are its
// answers where it does not give its own by overloading them.
#ifndef LACUNA_SCAN_FILE_FRAMES_H_
#define LACUNA_SCAN_FILE_FRAMES_H_

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/config.h"
#include "scan/data_location.h"
#include "scan/frame.h"
#include "scan/marker_tracks.h"
#include "scan/region.h"

namespace lacuna {

struct FileFrames {
  // One entry per frame, and in it one file per camera (one file where there are no cameras).
  std::vector<std::vector<std::filesystem::path>> files;
  std::optional<Region> crop;  // only points in it belong to the object; absent: all
  bool keep_largest = false;   // only the largest component (components.h) belongs to it
};

// Reads `crop: {box: …}` (or sphere or half_space) and `keep_largest` from the mapping `frames`.
// Throws InputError (file, line, column and field).
void ReadObjectChoice(const Config& frames, const DataLocation& data, FileFrames* source);

// A line of `lacuna info`: its label and its value.
using InfoLine = std::pair<std::string, std::string>;

// The number of frames in the files, before frames are chosen.
inline size_t CountFrames(const FileFrames& source) { return source.files.size(); }

// The times that the frame files themselves contain, s, one per frame; empty when they have none.
inline std::vector<double> TimesInFiles(const FileFrames&) { return {}; }

// One file per frame whose header (table_header.h) may have values; empty for other files.
inline std::vector<std::filesystem::path> FilesWithHeaders(const FileFrames&) { return {}; }

// Keeps only the frames `chosen` (numbers in the files, ascending), which are 0, 1, … from then on.
void KeepFrames(const std::vector<int>& chosen, FileFrames* source);

// The files that frame i is read from.
inline std::vector<std::filesystem::path> FilesOfFrame(const FileFrames& source, int i) {
  return source.files[i];
}

// All files that the frames are made from.
std::vector<std::filesystem::path> AllFiles(const FileFrames& source);

// Whether points without names are tracked: row i is the same material point in every frame.
inline bool IsTracked(const FileFrames&) { return false; }

// Whether one frame shows the surface of the object, so that it can be the reference shape.
inline bool ShowsSurface(const FileFrames&) { return true; }

// The named points of the frames; empty for frames without such points.
inline Markers NamedMarkers(const FileFrames&) { return {}; }

// Lets the source refine itself by its first frame, once everything else has been read. Returns
// true if this changes the frames. Appends to `warnings`.
inline bool RefineByFirstFrame(const Frame&, FileFrames*, std::vector<std::string>*) {
  return false;
}

// Doubts about the source that its first frame raises, one sentence each.
inline std::vector<std::string> DoubtsOfFirstFrame(const Frame&, const FileFrames&) { return {}; }

// Why frame 0 may have an implausible size (m, the diagonal of its bounding box) and what to check,
// as the end of a warning that begins "frame 0 is 114 m across".
std::string ExplainSize(const FileFrames& source, double size, const std::string& length_unit);

// Lines of `lacuna info` beside those that all recordings have.
inline std::vector<InfoLine> DescribeSource(const FileFrames&) { return {}; }

// The sizes, m, between which a soft object in front of a scanner lies. A size outside suggests a
// wrong unit and leads to a warning.
inline constexpr double kSmallestObject = 2e-3, kLargestObject = 20;

}  // namespace lacuna

#endif  // LACUNA_SCAN_FILE_FRAMES_H_
