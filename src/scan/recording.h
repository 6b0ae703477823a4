// A recording: a sequence of frames of one deforming object, and what is known about the object.
//
// It is described by recording.yaml (schema in docs/recording.md), which may lie beside data that
// were not made for Lacuna. All of it is checked when it is loaded; afterwards all numbers are in
// SI units and in the world frame. What depends on the kind of frames is behind frame_source.h.
#ifndef LACUNA_SCAN_RECORDING_H_
#define LACUNA_SCAN_RECORDING_H_

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/file_state.h"
#include "scan/frame.h"
#include "scan/frame_source.h"
#include "scan/instrument.h"
#include "scan/marker_tracks.h"
#include "scan/recorded_object.h"
#include "scan/reference_shape.h"

namespace lacuna {

struct Recording {
  std::filesystem::path file;  // the recording.yaml
  std::string name;
  DataLocation data;

  FrameSource frames;
  std::vector<double> times;         // s, ascending, one per frame
  std::filesystem::path times_file;  // empty when the times do not have a file of their own
  // m, the diagonal of the bounding box of the reference shape or, where that is the first frame,
  // of the points of that frame.
  double size = 0;
  Eigen::Index row_count = 0;  // rows of the first frame; if tracked, of every frame
  // The triangles of the first frame, if its points are tracked: the rows of their corners,
  // ascending, in ascending order.
  std::vector<std::array<int, 3>> faces;
  // The points that are identified by name: those of a marker file, or a selection of tracked
  // points that a prediction is compared with. Empty for scans.
  Markers markers;

  Instrument instrument;
  RecordedObject object;
  ReferenceShape reference;

  std::vector<std::string> warnings;  // e.g. a size that suggests another length unit
  std::string resolved;               // all values read, defaults included, SI, as JSON

  // All files that the recording consists of, recording.yaml included, and those that AddFileOf
  // adds; each once, in their states before they were read. A hash over them changes whenever the
  // recording does.
  std::vector<FileState> files;

  int FrameCount() const { return static_cast<int>(times.size()); }
};

// `path` is a recording.yaml or the folder that contains one. Checks that every file exists and
// reads the first frame. Throws InputError naming file, line, column and field, or file and frame.
Recording LoadRecording(const std::filesystem::path& path);
// The recording whose path an experiment gives under `key`. Throws InputError at the key where
// there is none.
Recording LoadRecording(const Config& config, const std::string& key);

// Adds the file that lists a region's nodes to Recording::files, in the state that it had before it
// was read. For regions that an experiment describes beside the recording. Does nothing if the
// region has no file or the file is listed already.
void AddFileOf(const Region& region, Recording* recording);

// A sentence about the first given path of a grip, or file of a force, that does not cover the time
// from frame `first` to frame `last` (time_span.h): by how much, and which field of recording.yaml
// names the file. Empty if there is none.
std::string DescribeUncoveredPath(const Recording& recording, int first, int last);
std::string DescribeUncoveredForce(const Recording& recording, int first, int last);

// Reads frame i in [0, FrameCount()). Points that are not finite are dropped and counted. Throws
// InputError naming file and frame when the file is absent, truncated or malformed, when fewer than
// four points (one marker) remain, when the number of tracked points changes, or when most of the
// triangles between tracked points are others than in frame 0. Safe to call from several threads at
// once.
Frame LoadFrame(const Recording& recording, int i);

// The triangles of a frame as Recording::faces has them.
std::vector<std::array<int, 3>> FacesByRow(const Frame& frame);

// Whether the points of the frames are tracked without having names: row i of every frame is the
// same material point.
bool HasTrackedPoints(const Recording& recording);

// Whether the frames are scans: neither markers nor tracked points, so that the points of two
// frames correspond only through the surface that they lie on.
bool IsScan(const Recording& recording);

// A summary for people, several lines: frames, duration, sizes, what is known about the object,
// warnings. Reads the first and the last frame.
std::string DescribeRecording(const Recording& recording);

}  // namespace lacuna

#endif  // LACUNA_SCAN_RECORDING_H_
