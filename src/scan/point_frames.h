// Frames of kind `points`: a point cloud per frame, from PLY, PCD or text tables.
//
// Everything that depends on this kind is here: its data, its reader, what it writes and what
// `lacuna info` says about it. frame_source.h lists what each function has to do.
#ifndef LACUNA_SCAN_POINT_FRAMES_H_
#define LACUNA_SCAN_POINT_FRAMES_H_

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/config.h"
#include "scan/data_location.h"
#include "scan/file_frames.h"
#include "scan/point_file.h"
#include "scan/similarity.h"
#include "scan/stepped_table.h"
#include "scan/virtual_scanner.h"

namespace lacuna {

struct PointFrames : FileFrames {
  static constexpr const char* kKind = "points";
  static constexpr const char* kTitle = "point clouds";

  Similarity world_from_file;  // its length unit included
  PointColumns columns;        // columns of text tables
  std::vector<double> ids;     // of the rows of all frames, where a table of image
                               // correlation gives them
  // 3 × rows of the first frame, in its unit, NaN where a point has none: where a table of image
  // correlation without numbers has its points in the reference state. 3 × 0: rows are in order.
  Eigen::Matrix3Xd places = Eigen::Matrix3Xd(3, 0);
  std::shared_ptr<const SteppedTable> steps;  // of one file with all frames; null: a file each
  std::vector<size_t> step;                   // of each frame, in `steps`
  std::vector<double> header_times;           // s, of each file, from the headers; may be empty
  bool tracked = false;                       // row i is the same material point in every frame
  Eigen::Matrix3Xi connectivity;              // 3 × m, rows of each frame, from 0; 3 × 0 without
  std::filesystem::path connectivity_file;    // empty without
  Eigen::Matrix3Xd sensors;  // 3 × c, m, where the points were seen from; 3 × 0: unknown
};

// The points of tables of image correlation (displacement_table.h) are tracked unless the recording
// says otherwise; row i of a frame is then the point that row i of the first file identifies by its
// number or, where the table has none, by its place in the reference state. Warns when the first
// file gives another length unit than recording.yaml.
void ReadSource(const Config& frames, const DataLocation& data, PointFrames* source,
                std::vector<std::string>* warnings);
// Throws InputError, beside the reasons of ReadPointFile, when none of the tracked points of a file
// is one of the first file.
void LoadPoints(const PointFrames& source, Frame* frame);
std::vector<double> TimesInFiles(const PointFrames& source);
void KeepFrames(const std::vector<int>& chosen, PointFrames* source);
std::vector<std::filesystem::path> FilesWithHeaders(const PointFrames& source);
std::vector<std::filesystem::path> AllFiles(const PointFrames& source);
inline bool IsTracked(const PointFrames& source) { return source.tracked; }

// Writes the points that the cameras measure on each surface, unordered, as frames/points_NNN.ply
// in `folder`. Returns the entries of `frames:` in recording.yaml. Throws InputError when no camera
// sees the object.
std::string WritePointFrames(const std::filesystem::path& folder, const VirtualScan& scan);

}  // namespace lacuna

#endif  // LACUNA_SCAN_POINT_FRAMES_H_
