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
#include "geometry/tet_mesh.h"

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
  std::vector<int> nodes;  // from 0, ascending, no duplicates
  // The file that lists them, in its state before it was read; an empty path if the YAML lists
  // them.
  FileState file = {};
  // The number of nodes of the reference file, to which `nodes` refer
  // (experiment/listed_regions.h). The mesh of the body has these and others, which were made from
  // them. 0: `nodes` are all nodes of the mesh that belong to the region.
  int file_nodes = 0;
  // Whether the file is a sheet, which the mesh has in several levels: node v + k·file_nodes
  // belongs to node v of the file (geometry/sheet.h).
  bool is_sheet = false;
};

struct Region {
  std::string name;
  std::variant<BoxRegion, SphereRegion, HalfSpaceRegion, NodeRegion> shape;
};

// Reads exactly one of `box: {min, max}`, `sphere: {center, radius}`, `half_space: {point,
// normal}`, `nodes: [..]`, `nodes_file: FILE` (.npy or text with whole numbers, in one column or in
// one row without names; relative to `data_folder`), and `name` (default: `default_name`). Throws
// InputError (file, line, column and field) when there is not exactly one, or naming the file of
// nodes when that is malformed.
Region ReadRegion(const Config& config, const std::filesystem::path& data_folder,
                  const std::string& default_name);

// The numbers of the mesh nodes in the region, ascending. A region that lists nodes of the
// reference file has, besides these, all levels of a sheet, and the added midpoints of those edges
// both of whose ends belong to the region. Throws InputError with the name of the region when there
// is none or a listed node does not exist.
std::vector<int> SelectNodes(const Region& region, const TetMesh& mesh);

// The numbers of the points (columns, m) in a region that is a shape (CHECKed), ascending. Throws
// InputError with the name of the region when there is none.
std::vector<int> SelectPoints(const Region& region, const Eigen::Matrix3Xd& points);

// Whether a region that is a shape has a point in common with the box (m); true for listed nodes.
bool Meets(const Region& region, const Eigen::AlignedBox3d& box);

// The corners of a box (m): "from (0, 0, 0) to (0.1, 0.02, 0.02) m".
std::string DescribeCorners(const Eigen::AlignedBox3d& box);

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
