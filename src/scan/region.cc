#include "scan/region.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "core/npy.h"
#include "core/quoted_text.h"
#include "geometry/shape_functions.h"
#include "geometry/tri_mesh.h"
#include "scan/delimited_table.h"
#include "scan/yaml_format.h"

namespace lacuna {
namespace {

// Rounding must not decide whether a node on the border of a region belongs to the region.
constexpr double kBorder = 1e-9;  // m

std::vector<int> SortedUnique(std::vector<int> nodes) {
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

std::vector<int> ReadNodeFile(const std::filesystem::path& file) {
  DelimitedTable table;
  if (file.extension() == ".npy")
    table.values = ReadNpyMatrix(file);
  else
    table = ReadDelimitedTable(file);
  const Eigen::MatrixXd& numbers = table.values;
  // A second column may be the index that a program puts in front of each row.
  const bool is_one_row = numbers.rows() == 1 && table.header.empty();
  if (numbers.cols() > 1 && !is_one_row)
    throw InputError({file.string()},
                     fmt::format("has {} columns; expected the numbers of the nodes in one column, "
                                 "without an index in front of them",
                                 numbers.cols()));
  std::vector<int> nodes;
  for (const double number : numbers.reshaped()) {
    if (!(number >= 0 && number < 1e9 && number == std::floor(number))) {
      throw InputError({file.string()},
                       fmt::format("got {} as a node number; expected a whole number ≥ 0", number));
    }
    nodes.push_back(static_cast<int>(number));
  }
  if (nodes.empty()) throw InputError({file.string()}, "lists no node");
  return SortedUnique(std::move(nodes));
}

BoxRegion ReadBox(const Config& config) {
  const Eigen::Vector3d min = config.Vector("min", kLength);
  const Eigen::Vector3d max = config.Vector("max", kLength);
  if ((min.array() > max.array()).any()) config.Fail("max", "lies below min");
  return {Eigen::AlignedBox3d(min, max)};
}

HalfSpaceRegion ReadHalfSpace(const Config& config) {
  HalfSpaceRegion region;
  region.point = config.Vector("point", kLength);
  region.normal = config.Vector("normal", kDimensionless);
  if (region.normal.norm() == 0) config.Fail("normal", "has no direction");
  region.normal.normalize();
  return region;
}

// Adds the midpoints of the edges both of whose ends are in the region, except for midpoints that
// the file numbers itself.
void AddMidpoints(const TetMesh& mesh, int file_nodes, std::vector<char>* is_in) {
  for (const auto tet : mesh.tets.colwise())
    for (int edge = 0; edge < 6; ++edge) {
      const int midpoint = tet[4 + edge];
      const auto& [a, b] = kTetEdges[static_cast<size_t>(edge)];
      if (midpoint >= file_nodes && (*is_in)[tet[a]] && (*is_in)[tet[b]]) (*is_in)[midpoint] = 1;
    }
}

std::vector<int> NodesOfList(const NodeRegion& listed, const std::string& name,
                             const TetMesh& mesh) {
  const int count = static_cast<int>(mesh.NodeCount());
  const int numbered = listed.file_nodes > 0 ? std::min(listed.file_nodes, count) : count;
  if (listed.nodes.empty()) throw InputError(fmt::format("region \"{}\" lists no node", name));
  if (listed.nodes.back() >= numbered)
    throw InputError(
        fmt::format("region \"{}\" lists node {}; the reference shape has {} nodes, counted from 0",
                    name, listed.nodes.back(), numbered));
  if (listed.file_nodes == 0) return listed.nodes;
  std::vector<char> is_in(static_cast<size_t>(count), 0);
  const int corners = mesh.tets.topRows(4).maxCoeff() + 1;
  for (const int node : listed.nodes) {
    is_in[node] = 1;
    for (int level = node + numbered; listed.is_sheet && level < corners; level += numbered)
      is_in[level] = 1;
  }
  if (mesh.Order() == 2) AddMidpoints(mesh, numbered, &is_in);
  std::vector<int> nodes;
  for (int node = 0; node < count; ++node)
    if (is_in[node]) nodes.push_back(node);
  return nodes;
}

struct ContainsPoint {
  Eigen::Vector3d x;
  bool operator()(const BoxRegion& region) const {
    return region.box.squaredExteriorDistance(x) <= kBorder * kBorder;
  }
  bool operator()(const SphereRegion& region) const {
    return (x - region.center).norm() <= region.radius + kBorder;
  }
  bool operator()(const HalfSpaceRegion& region) const {
    return (x - region.point).dot(region.normal) >= -kBorder;
  }
  bool operator()(const NodeRegion&) const { return false; }
};

struct MeetsBox {
  Eigen::AlignedBox3d box;
  bool operator()(const BoxRegion& region) const {
    return region.box.squaredExteriorDistance(box) <= kBorder * kBorder;
  }
  bool operator()(const SphereRegion& region) const {
    return box.exteriorDistance(region.center) <= region.radius + kBorder;
  }
  bool operator()(const HalfSpaceRegion& region) const {
    const Eigen::Vector3d farthest =
        (region.normal.array() > 0).select(box.max().array(), box.min().array());
    return ContainsPoint{farthest}(region);
  }
  bool operator()(const NodeRegion&) const { return true; }
};

std::string Triple(const Eigen::Vector3d& v) {
  return fmt::format("({:g}, {:g}, {:g})", v.x(), v.y(), v.z());
}
std::string Lengths(const Eigen::Vector3d& v) { return FormatVector(v, "m"); }

}  // namespace

Region ReadRegion(const Config& config, const std::filesystem::path& data_folder,
                  const std::string& default_name) {
  Region region;
  region.name = config.Text("name", default_name);
  int shapes = 0;
  if (const auto box = config.OptionalChild("box")) {
    region.shape = ReadBox(*box);
    ++shapes;
  }
  if (const auto sphere = config.OptionalChild("sphere")) {
    region.shape = SphereRegion{sphere->Vector("center", kLength),
                                sphere->Quantity("radius", kLength, kPositive)};
    ++shapes;
  }
  if (const auto half_space = config.OptionalChild("half_space")) {
    region.shape = ReadHalfSpace(*half_space);
    ++shapes;
  }
  if (config.Has("nodes")) {
    region.shape = NodeRegion{SortedUnique(config.Integers("nodes", 0)), {}};
    ++shapes;
  }
  if (config.Has("nodes_file")) {
    const FileState file = StateOf(data_folder / config.Text("nodes_file"));
    region.shape = NodeRegion{ReadNodeFile(file.file), file};
    ++shapes;
  }
  if (shapes != 1) {
    config.Fail("", fmt::format("describes {} shapes; expected exactly one of box, sphere, "
                                "half_space, nodes, nodes_file",
                                shapes));
  }
  return region;
}

AxisSet ReadDirections(const Config& config) {
  if (!config.Has("directions")) return AxisSet::All();
  const std::vector<std::string> names = config.Texts("directions");
  AxisSet axes;
  for (size_t k = 0; k < names.size(); ++k) {
    const size_t axis =
        names[k].size() == 1 ? std::string("xyz").find(names[k]) : std::string::npos;
    if (axis == std::string::npos)
      config.FailAtItem(
          "directions", k,
          fmt::format("got \"{}\"; expected x, y or z: choose the coordinate system so "
                      "that these are the directions of the support",
                      names[k]));
    if (axes.Has(static_cast<int>(axis)))
      config.FailAtItem("directions", k, fmt::format("{} appears twice", names[k]));
    axes = axes | AxisSet::Of(static_cast<int>(axis));
  }
  if (axes.IsEmpty()) config.Fail("directions", "is empty; expected axes, e.g. [x]");
  return axes;
}

std::string WithDirections(std::string mapping, AxisSet axes) {
  if (axes.IsAll()) return mapping;
  mapping.pop_back();
  return mapping + ", directions: [" + axes.Names() + "]}";
}

std::vector<int> SelectNodes(const Region& region, const TetMesh& mesh) {
  const auto* listed = std::get_if<NodeRegion>(&region.shape);
  return listed != nullptr ? NodesOfList(*listed, region.name, mesh)
                           : SelectPoints(region, mesh.nodes);
}

std::vector<int> SelectPoints(const Region& region, const Eigen::Matrix3Xd& points) {
  CHECK(!std::holds_alternative<NodeRegion>(region.shape)) << region.name;
  std::vector<int> selected;
  for (int i = 0; i < points.cols(); ++i)
    if (Contains(region, points.col(i))) selected.push_back(i);
  if (selected.empty()) {
    throw InputError(
        fmt::format("region \"{}\" ({}) holds no node of the reference shape, which extends {}",
                    region.name, DescribeRegion(region), DescribeCorners(BoundingBox(points))));
  }
  return selected;
}

bool Meets(const Region& region, const Eigen::AlignedBox3d& box) {
  return std::visit(MeetsBox{box}, region.shape);
}

std::string DescribeCorners(const Eigen::AlignedBox3d& box) {
  return fmt::format("from {} to {} m", Triple(box.min()), Triple(box.max()));
}

bool Contains(const Region& region, const Eigen::Vector3d& point) {
  return std::visit(ContainsPoint{point}, region.shape);
}

std::string DescribeRegion(const Region& region) {
  struct Describe {
    std::string operator()(const BoxRegion& r) const { return "box " + DescribeCorners(r.box); }
    std::string operator()(const SphereRegion& r) const {
      return fmt::format("sphere around {} m of radius {:g} m", Triple(r.center), r.radius);
    }
    std::string operator()(const HalfSpaceRegion& r) const {
      return fmt::format("half-space beyond {} m along {}", Triple(r.point), Triple(r.normal));
    }
    std::string operator()(const NodeRegion& r) const {
      return fmt::format("{} nodes of the reference file", r.nodes.size());
    }
  };
  return std::visit(Describe{}, region.shape);
}

std::string FormatRegion(const Region& region) {
  struct Format {
    std::string operator()(const BoxRegion& r) const {
      return fmt::format("box: {{min: {}, max: {}}}", Lengths(r.box.min()), Lengths(r.box.max()));
    }
    std::string operator()(const SphereRegion& r) const {
      return fmt::format("sphere: {{center: {}, radius: {} m}}", Lengths(r.center), r.radius);
    }
    std::string operator()(const HalfSpaceRegion& r) const {
      return fmt::format("half_space: {{point: {}, normal: [{}, {}, {}]}}", Lengths(r.point),
                         r.normal.x(), r.normal.y(), r.normal.z());
    }
    std::string operator()(const NodeRegion& r) const {
      return fmt::format("nodes: [{}]", fmt::join(r.nodes, ", "));
    }
  };
  return fmt::format("{{name: {}, {}}}", QuotedText(region.name),
                     std::visit(Format{}, region.shape));
}

}  // namespace lacuna
