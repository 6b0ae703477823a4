// A recording: a sequence of frames of one object, and what is known about it.
//
// recording.yaml describes files that may lie elsewhere; it is the user's own words about data
// that need not have been made for Lacuna. All of it is checked when it is loaded, all numbers
// are SI and in the world frame afterwards. The schema stands in docs/recording.md.
#ifndef LACUNA_SCAN_RECORDING_H_
#define LACUNA_SCAN_RECORDING_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scan/camera_alignment.h"
#include "scan/depth_image.h"
#include "scan/frame.h"
#include "scan/marker_tracks.h"
#include "scan/point_file.h"
#include "scan/region.h"
#include "scan/similarity.h"

namespace lacuna {

enum class FrameKind { kPoints, kMesh, kDepth, kMarkers };

// A part of the object that is moved from outside.
enum class GripMotion {
  kFollowsScan,     // as the scanned surface moves there
  kFollowsMarkers,  // with the named markers
  kGiven            // along a given path
};
struct RecordedGrip {
  Region region;
  GripMotion motion = GripMotion::kFollowsScan;
  std::vector<std::string> markers;  // kFollowsMarkers
  bool deforms = false;              // it need not move as a rigid body; not kGiven
  Eigen::VectorXd times;             // kGiven: k, s, ascending
  Eigen::Matrix3Xd displacements;    // kGiven: 3 × k, m, from the undeformed place
  Eigen::Matrix3Xd turns;  // kGiven: 3 × k, rad, rotation vectors; 3 × 0: it does not turn
  Eigen::Vector3d pivot =
      Eigen::Vector3d::Zero();  // kGiven: m, what it turns about before it shifts
  std::filesystem::path file;   // kGiven
};

// A force that was measured while scanning; it acts on the object.
struct MeasuredForce {
  std::string name;
  std::optional<Region> region;  // where it acts, if that is known
  Eigen::VectorXd times;         // k, s, ascending
  Eigen::Matrix3Xd forces;       // 3 × k, N, resultant, world frame
  std::filesystem::path file;    // empty: a constant
};

// Linear between the measured times; before the first and after the last it stays.
Eigen::Vector3d ForceAt(const MeasuredForce& force, double time);

// The rigid motion of a grip with a given path, from its undeformed place. Between the given times
// a cubic through them whose velocity is continuous: corners in a path would shake the body. Before
// the first and after the last it stays.
Eigen::Isometry3d MotionAt(const RecordedGrip& grip, double time);

// Where the undeformed shape comes from.
enum class ReferenceSource { kFirstFrame, kMesh, kTetMesh };
// Which face of a sheet's material the surface is.
enum class SheetFace { kMiddle, kFront };
struct ReferenceShape {
  ReferenceSource source = ReferenceSource::kFirstFrame;
  std::filesystem::path file;  // kMesh, kTetMesh
  Similarity world_from_file;  // its length unit included
  double sheet_thickness = 0;  // m; > 0: the surface is an open sheet of that thickness
  SheetFace sheet_face = SheetFace::kMiddle;
};

struct Recording {
  std::filesystem::path file;         // the recording.yaml
  std::filesystem::path data_folder;  // where its files lie
  std::string name;

  FrameKind kind = FrameKind::kPoints;
  std::vector<double> times;                                    // s, ascending, one per frame
  std::vector<std::vector<std::filesystem::path>> frame_files;  // per frame, per camera; empty for
                                                                // markers
  std::string length_unit;                                      // of the frame files: "mm"
  Similarity world_from_file;                                   // its length unit included
  PointColumns columns;
  bool tracked = false;           // row i is the same material point in every frame
  Eigen::Index row_count = 0;     // of the first frame; tracked: of every frame
  Eigen::Matrix3Xi connectivity;  // 3 × m, 0-based rows of each frame; 3 × 0 without
  std::filesystem::path connectivity_file, times_file;  // empty without
  Eigen::Matrix3Xd sensors;  // 3 × c, m, where the points were seen from; 3 × 0: unknown

  std::vector<Camera> cameras;                       // kDepth; poses after the refinement
  std::vector<CameraCorrection> camera_corrections;  // what it did; empty when not asked for
  double depth_unit = 0;                             // m per count
  double min_depth = 0, max_depth = 0;               // m; other depths are dropped

  std::filesystem::path marker_file;  // kMarkers
  MarkerTracks markers;               // world frame, m; the frames that were chosen
  Eigen::Matrix3Xd marker_places;     // 3 × m, m, on the undeformed object; NaN where not told

  std::optional<double> density;           // kg/m³
  std::optional<Eigen::Vector3d> gravity;  // m/s²
  std::vector<Region> fixed;
  std::vector<RecordedGrip> grips;
  std::vector<MeasuredForce> forces;
  ReferenceShape reference;

  std::vector<std::string> warnings;  // e.g. a size that suggests another length unit
  std::string resolved;               // all values read, defaults included, SI, as JSON

  int FrameCount() const { return static_cast<int>(times.size()); }
};

// `path` is a recording.yaml or the folder that holds one. Every file is looked for and the first
// frame is read. Throws InputError naming file:line:column and field, or file and frame.
Recording LoadRecording(const std::filesystem::path& path);

// Frame i in [0, FrameCount()). Points that are not finite are dropped and counted. Throws
// InputError naming file and frame when the file is absent, truncated or malformed, when fewer than
// four points (one marker) remain, or, for tracked points, when their number differs.
Frame LoadFrame(const Recording& recording, int i);

// All files that the recording consists of, itself included, each once: what a hash must cover.
std::vector<std::filesystem::path> RecordingFiles(const Recording& recording);

// For people: frames, duration, sizes, what is known, warnings. Reads the first and last frame.
std::string DescribeRecording(const Recording& recording);

}  // namespace lacuna

#endif  // LACUNA_SCAN_RECORDING_H_
