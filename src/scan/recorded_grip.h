// Parts of the object that are moved from outside while it is scanned.
#ifndef LACUNA_SCAN_RECORDED_GRIP_H_
#define LACUNA_SCAN_RECORDED_GRIP_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "core/config.h"
#include "geometry/axis_set.h"
#include "scan/data_location.h"
#include "scan/region.h"

namespace lacuna {

enum class GripMotion {
  kFollowsScan,     // the motion of the scanned surface in its region
  kFollowsMarkers,  // the motion of the named markers
  kGiven            // a given path
};

// How well the place of a held part is known: standard deviations, for each axis, of a translation
// (m) and of a rotation (rad) about the middle of the part. 0: it is exact.
struct PlacementDeviation {
  double shift = 0, turn = 0;
  bool IsExact() const { return shift == 0 && turn == 0; }
};

struct RecordedGrip {
  Region region;
  GripMotion motion = GripMotion::kFollowsScan;
  AxisSet axes = AxisSet::All();  // along which it is held; all unless it is kGiven
  bool deforms = false;  // whether it may deform instead of moving as a rigid body; not kGiven
  std::vector<std::string> markers;  // kFollowsMarkers
  PlacementDeviation placement = {};

  // kGiven: k poses relative to the undeformed place. The grip is rotated about `pivot`, from the
  // first rotation to that of the pose, and then displaced.
  Eigen::VectorXd times;           // k, s, ascending
  Eigen::Matrix3Xd displacements;  // 3 × k, m
  Eigen::Matrix3Xd rotations;      // 3 × k, rad, rotation vectors; 3 × 0: it does not rotate
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();  // m
  std::filesystem::path file;                       // file of the path
  std::vector<std::string> turn_columns;            // in that file; empty where they have no names
  bool turns_in_radians = false;                    // the numbers in these columns
};

// The rigid motion of a grip of motion kGiven from its undeformed place, where it is at the time
// `since` (s) or, if none is given, in the first row of its path. Its displacement and its rotation
// vector follow a smooth path through the rows (geometry/smooth_path.h), because corners would
// excite vibrations. Before the first row the grip rests. After the last row, at the time T, it
// goes on as far as it came in an equally long time before: x(T + s) = 2 x(T) − x(T − s), at most
// as far as it came since the first row. The last time step of a prediction ends after the last
// frame, in which the grip need not have stopped, and a jump of its velocity would be a shock.
Eigen::Isometry3d MotionAt(const RecordedGrip& grip, double time);
Eigen::Isometry3d MotionAt(const RecordedGrip& grip, double time, double since);

// The largest distance, m, from the first row, and the largest angle, rad, turned since; 0 unless
// the path is given.
struct PathRange {
  double shift = 0, turn = 0;
};
PathRange RangeOfPath(const RecordedGrip& grip);

// Reads `placement: {shift_deviation: 1 mm, turn_deviation: 1 deg}` of a held part, of which at
// least one must be above 0; without it the placement is exact. The part must be held along all
// axes. Throws InputError.
PlacementDeviation ReadPlacement(const Config& config, AxisSet axes);
// Adds the placement to an item of `fixed` or `gripped`, unless it is exact.
std::string WithPlacement(std::string mapping, const PlacementDeviation& placement);

// Reads the items of `gripped`: each a region (region.h) and one of
//   follows: scan                     the default
//   follows_markers: [a, b]           names among `marker_names`
//   path: {file, time, x, y, z, time_unit, length_unit, turn: {x, y, z, unit, about}}
// A path has one row per time, the first of which belongs to the undeformed place; `turn` names
// three more columns of the same file with a rotation vector about the point `about`, of
// which the multiples of full turns about its axis are chosen that make it continuous. `deforms:
// true` lets a grip that follows something deform with it. `directions: [z]` beside a path without
// `turn` leaves the part free along the other axes, like plates without friction. `frames` are all
// frames in the files, `marker_names` is empty when the frames have no markers. Throws InputError
// (file, line, column and field).
std::vector<RecordedGrip> ReadGrips(const Config& config, const DataLocation& data,
                                    const FrameData& frames,
                                    const std::vector<std::string>& marker_names);

// What `lacuna info` says about a grip.
std::string DescribeGrip(const RecordedGrip& grip);

// The grip as an item of `gripped` in recording.yaml. A given path goes into the file
// grip`number`.csv of `folder`.
std::string WriteGrip(const std::filesystem::path& folder, const RecordedGrip& grip, size_t number);

}  // namespace lacuna

#endif  // LACUNA_SCAN_RECORDED_GRIP_H_
