// Regions: the parts of an object that are fixed, gripped or loaded, described by a simple shape or
// by the numbers of nodes.
#ifndef LACUNA_SCAN_REGION_H_
#define LACUNA_SCAN_REGION_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "core/config.h"
#include "core/file_state.h"
#include "geometry/axis_set.h"

namespace lacuna {

// Shapes in the world frame, m. A region consists of those nodes of the undeformed reference shape
// that lie inside or on the border.
struct BoxRegion {
  Eigen::AlignedBox3d box;
};
struct SphereRegion {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0;
};
// The points x with (x − point)·normal ≥ 0, i.e. the side that the normal points to.
struct HalfSpaceRegion {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit length
};
struct NodeRegion {
  std::vector<int> nodes;  // nodes of the reference mesh, from 0, ascending, no duplicates
  // The file that lists them, in its state before it was read; an empty path if the YAML lists
  // them.
  FileState file = {};
};

struct Region {
  std::string name;
  std::variant<BoxRegion, SphereRegion, HalfSpaceRegion, NodeRegion> shape;
};

// Reads exactly one of `box: {min, max}`, `sphere: {center, radius}`, `half_space: {point,
// normal}`, `nodes: [..]`, `nodes_file: FILE` (.npy or text with whole numbers; relative to
// `data_folder`), and `name` (default: `default_name`). Throws InputError (file, line, column and
// field) when there is not exactly one, or naming the file of nodes when that is malformed.
Region ReadRegion(const Config& config, const std::filesystem::path& data_folder,
                  const std::string& default_name);

// The numbers of the nodes (columns of `nodes`, 3 × n, m) in the region, ascending. Throws
// InputError with the name of the region when there is none or a listed node does not exist.
std::vector<int> SelectNodes(const Region& region, const Eigen::Matrix3Xd& nodes);

// Whether the point (m, world frame) lies in a region that is a shape; false for listed nodes.
bool Contains(const Region& region, const Eigen::Vector3d& point);

// The shape in words, e.g. "box from (0, 0, 0) to (0.03, 0.1, 0.03) m".
std::string DescribeRegion(const Region& region);

// Reads `directions: [x, z]` beside a region, the axes along which a part is held; all axes without
// it. Throws InputError for an empty list, an axis that appears twice, or another word.
AxisSet ReadDirections(const Config& config);
// Adds the directions to a YAML flow mapping; nothing where these are all axes.
std::string WithDirections(std::string mapping, AxisSet axes);

// The region as a YAML flow mapping that ReadRegion reads back to the same numbers.
std::string FormatRegion(const Region& region);

}  // namespace lacuna

#endif  // LACUNA_SCAN_REGION_H_
