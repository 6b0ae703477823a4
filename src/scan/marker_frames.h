// Frames of kind `markers`: named points whose tracks a motion-capture system has recorded in one
// file (CSV, TRC or C3D).
//
// Everything that depends on this kind is here: its data, its reader, its writer and what
// `lacuna info` says about it. frame_source.h lists what each function has to do.
#ifndef LACUNA_SCAN_MARKER_FRAMES_H_
#define LACUNA_SCAN_MARKER_FRAMES_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "core/config.h"
#include "scan/data_location.h"
#include "scan/file_frames.h"
#include "scan/frame.h"
#include "scan/marker_tracks.h"
#include "scan/similarity.h"

namespace lacuna {

struct MarkerFrames {
  static constexpr const char* kKind = "markers";
  static constexpr const char* kTitle = "marker tracks";

  std::filesystem::path file;
  std::filesystem::path places_file;  // table of the places; empty: recording.yaml lists them
  Similarity world_from_file;         // its length unit included
  MarkerTracks tracks;      // all frames as in the file until KeepFrames; then those that were
                            // chosen, in m and in the world frame
  Eigen::Matrix3Xd places;  // 3 × markers, m, on the undeformed object; NaN where not given
};

// Warns when the file gives another length unit than recording.yaml, and of markers at exactly
// (0, 0, 0).
void ReadSource(const Config& frames, const DataLocation& data, MarkerFrames* source,
                std::vector<std::string>* warnings);
// Throws InputError when a marker lies so far from the origin that its position is no measurement.
void KeepFrames(const std::vector<int>& chosen, MarkerFrames* source);
// Row i of the frame is marker i. Markers that were not seen are dropped.
void LoadPoints(const MarkerFrames& source, Frame* frame);
std::vector<std::filesystem::path> AllFiles(const MarkerFrames& source);
std::vector<double> TimesInFiles(const MarkerFrames& source);
// About the tracks in all frames (track_doubts.h).
std::vector<std::string> DoubtsOfFirstFrame(const Frame& first, const MarkerFrames& source);
Markers NamedMarkers(const MarkerFrames& source);
std::string ExplainSize(const MarkerFrames& source, double size, const std::string& length_unit);
std::vector<InfoLine> DescribeSource(const MarkerFrames& source);

inline size_t CountFrames(const MarkerFrames& source) { return source.tracks.positions.size(); }
inline std::vector<std::filesystem::path> FilesOfFrame(const MarkerFrames& source, int) {
  return {source.file};
}
inline std::vector<std::filesystem::path> FilesWithHeaders(const MarkerFrames&) { return {}; }
inline bool IsTracked(const MarkerFrames&) { return false; }
inline bool ShowsSurface(const MarkerFrames&) { return false; }
inline bool RefineByFirstFrame(const Frame&, MarkerFrames*, std::vector<std::string>*) {
  return false;
}

// Writes markers.csv in `folder`: a column `t` with `times` (s, one per frame), then the
// coordinates of each marker, m, with nine decimals. Returns the entries of `frames:` in
// recording.yaml, with which the names are read back as they are. Throws InputError for a name with
// a line break.
std::string WriteMarkerFrames(const std::filesystem::path& folder, const std::vector<double>& times,
                              const Markers& markers);

}  // namespace lacuna

#endif  // LACUNA_SCAN_MARKER_FRAMES_H_
