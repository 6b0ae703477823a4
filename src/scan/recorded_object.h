// What a recording says about the object besides its frames.
#ifndef LACUNA_SCAN_RECORDED_OBJECT_H_
#define LACUNA_SCAN_RECORDED_OBJECT_H_

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "geometry/axis_set.h"
#include "scan/data_location.h"
#include "scan/measured_force.h"
#include "scan/measured_reaction.h"
#include "scan/recorded_grip.h"
#include "scan/region.h"

namespace lacuna {

// A part that does not move, or only perpendicular to some of the coordinate axes: `axes` {x}
// leaves the part free to move along y and z, as on a plane of symmetry x = constant.
struct RecordedSupport {
  Region region;
  AxisSet axes = AxisSet::All();
  PlacementDeviation placement = {};
};

struct RecordedObject {
  std::optional<double> density;           // kg/m³
  std::optional<Eigen::Vector3d> gravity;  // m/s², world frame
  std::vector<RecordedSupport> fixed;      // parts that do not move
  std::vector<RecordedGrip> grips;         // parts that are moved from outside
  std::vector<MeasuredForce> forces;
  std::vector<MeasuredReaction> reactions;  // forces and torques that the grips exert
};

// Reads the items of `fixed`: each a region (region.h) and optionally `directions: [x, y]`, the
// axes along which it cannot move, and `placement`. Throws InputError (file, line, column and
// field).
std::vector<RecordedSupport> ReadSupports(const Config& config, const DataLocation& data);

// What `lacuna info` says about a support, and the support as an item of `fixed` in recording.yaml.
std::string DescribeSupport(const RecordedSupport& support);
std::string WriteSupport(const RecordedSupport& support);

// The regions that the object has: of the parts that are held, and where forces act.
std::vector<const Region*> RegionsIn(const RecordedObject& object);
std::vector<Region*> RegionsIn(RecordedObject* object);

// The names of the held parts, the axes along which they are held, and how well their placement is
// known: the fixed regions, then the gripped ones.
std::vector<std::string> HeldParts(const RecordedObject& object);
std::vector<AxisSet> HeldAxesOfParts(const RecordedObject& object);
std::vector<PlacementDeviation> PlacementDeviationsOfParts(const RecordedObject& object);

// The files that the object's regions, paths, forces and reactions were read from.
std::vector<std::filesystem::path> FilesOf(const RecordedObject& object);

// Doubts about the object, one sentence each: its density, loads and paths whose times do not
// belong to a recording from `first` to `last` (s), and paths with gaps or a doubtful turn
// (path_doubts.h).
std::vector<std::string> DoubtsOfObject(const RecordedObject& object, double first, double last);

// Doubts about paths that jump by more than the object's `size` (m), not after `last` (s).
std::vector<std::string> DoubtsOfJumps(const RecordedObject& object, double size, double last);

// A sentence about a density (kg/m³) that no soft object has; empty if there is no doubt.
std::string DoubtOfDensity(double density);

}  // namespace lacuna

#endif  // LACUNA_SCAN_RECORDED_OBJECT_H_
