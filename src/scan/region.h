// Parts of an object that are held, gripped or pushed, told by shape or by node numbers.
#ifndef LACUNA_SCAN_REGION_H_
#define LACUNA_SCAN_REGION_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "core/config.h"

namespace lacuna {

// Shapes in the world frame, m, laid over the undeformed reference shape. Borders belong to them.
struct BoxRegion {
  Eigen::AlignedBox3d box;
};
struct SphereRegion {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0;
};
// The points x with (x − point)·normal ≥ 0: the side that the normal points to.
struct HalfSpaceRegion {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};
struct NodeRegion {
  std::vector<int> nodes;      // of the reference mesh, 0-based, ascending, each once
  std::filesystem::path file;  // they came from; empty: from the YAML itself
};

struct Region {
  std::string name;
  std::variant<BoxRegion, SphereRegion, HalfSpaceRegion, NodeRegion> shape;
};

// Reads exactly one of `box: {min, max}`, `sphere: {center, radius}`, `half_space: {point,
// normal}`, `nodes: [..]`, `nodes_file: FILE` (.npy, or a text of whole numbers; relative to
// `data_folder`) and `name` (default: `default_name`).
Region ReadRegion(const Config& config, const std::filesystem::path& data_folder,
                  const std::string& default_name);

// The nodes (columns of `nodes`, 3 × n, m) inside the region, ascending. Throws InputError with the
// region's name when there is none or a listed node does not exist.
std::vector<int> SelectNodes(const Region& region, const Eigen::Matrix3Xd& nodes);

// "box from (0, 0, 0) to (0.03, 0.1, 0.03) m"
std::string DescribeRegion(const Region& region);

// The region as a YAML flow mapping that ReadRegion reads back to the same numbers.
std::string FormatRegion(const Region& region);

}  // namespace lacuna

#endif  // LACUNA_SCAN_REGION_H_
