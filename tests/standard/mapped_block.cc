#include "standard/mapped_block.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/error.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

BlockMap Box(const Config& config) {
  const Eigen::Vector3d size = config.Vector("size", kLength);
  const Eigen::Vector3d origin = config.Vector("origin", kLength, Eigen::Vector3d::Zero());
  return [size, origin](const Eigen::Vector3d& uvw) -> Eigen::Vector3d {
    return origin + size.cwiseProduct(uvw);
  };
}

BlockMap Panel(const Config& config) {
  std::array<Eigen::Vector2d, 4> corner;
  const char* names[] = {"corner_00", "corner_10", "corner_11", "corner_01"};
  for (size_t k = 0; k < 4; ++k) {
    const std::vector<double> at = config.Quantities(names[k], kLength, kAnyValue);
    if (at.size() != 2) config.Fail(names[k], "expected two lengths");
    corner[k] = {at[0], at[1]};
  }
  const double thickness = config.Quantity("thickness", kLength, kPositive);
  return [corner, thickness](const Eigen::Vector3d& uvw) -> Eigen::Vector3d {
    const double u = uvw[0], v = uvw[1];
    const Eigen::Vector2d xy = (1 - u) * (1 - v) * corner[0] + u * (1 - v) * corner[1] +
                               u * v * corner[2] + (1 - u) * v * corner[3];
    return {xy[0], xy[1], thickness * uvw[2]};
  };
}

Eigen::Vector2d ReadPair(const Config& config, const char* key) {
  const std::vector<double> values = config.Quantities(key, kLength, kPositive);
  if (values.size() != 2) config.Fail(key, "expected two lengths");
  return {values[0], values[1]};
}

BlockMap EllipticPlate(const Config& config) {
  const Eigen::Vector2d inner = ReadPair(config, "inner"), outer = ReadPair(config, "outer");
  const double thickness = config.Quantity("thickness", kLength, kPositive);
  return [=](const Eigen::Vector3d& uvw) -> Eigen::Vector3d {
    const Eigen::Vector2d axes = (1 - uvw[0]) * inner + uvw[0] * outer;
    const double angle = 0.5 * std::numbers::pi * uvw[1];
    return {axes[0] * std::cos(angle), axes[1] * std::sin(angle), thickness * uvw[2]};
  };
}

BlockMap Paraboloid(const Config& config) {
  const Eigen::Vector3d size = config.Vector("size", kLength);
  const double radius = config.Quantity("radius", kLength, kPositive);
  return [size, radius](const Eigen::Vector3d& uvw) -> Eigen::Vector3d {
    const Eigen::Vector3d at = size.cwiseProduct(uvw.cwiseAbs2());
    const double lower = at.head<2>().squaredNorm() / (2 * radius);
    return {at.x(), at.y(), at.z() + (1 - at.z() / size.z()) * lower};
  };
}

}  // namespace

BlockMap ReadBlockMap(const Config& config) {
  using Reader = BlockMap (*)(const Config&);
  return config.Choice<Reader>("shape", {{"box", &Box},
                                         {"panel", &Panel},
                                         {"elliptic_plate", &EllipticPlate},
                                         {"paraboloid", &Paraboloid}})(config);
}

bool BlockPart::Contains(const Eigen::Vector3d& uvw) const {
  constexpr double kRounding = 1e-9;
  for (int k = 0; k < 3; ++k) {
    const std::optional<double>& value = at[static_cast<size_t>(k)];
    if (value && std::abs(uvw[k] - *value) > kRounding) return false;
  }
  return true;
}

BlockPart ReadBlockPart(const Config& config) {
  BlockPart part;
  const char* names[] = {"u", "v", "w"};
  for (size_t k = 0; k < 3; ++k)
    if (config.Has(names[k])) part.at[k] = config.Number(names[k], {0, 1, false, false});
  return part;
}

Eigen::VectorXi MappedBlock::NodesOf(const BlockPart& part) const {
  std::vector<int> nodes;
  for (Eigen::Index i = 0; i < uvw.cols(); ++i)
    if (part.Contains(uvw.col(i))) nodes.push_back(static_cast<int>(i));
  if (nodes.empty()) throw InputError("a part of the block has no node on this mesh");
  return Eigen::Map<Eigen::VectorXi>(nodes.data(), static_cast<Eigen::Index>(nodes.size()));
}

MappedBlock MeshBlock(const BlockMap& map, const std::array<int, 3>& cells, int order) {
  MappedBlock block;
  block.mesh = BoxMesh(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), cells, order);
  block.uvw = block.mesh.nodes;
  for (Eigen::Index i = 0; i < block.uvw.cols(); ++i)
    block.mesh.nodes.col(i) = map(block.uvw.col(i));
  return block;
}

}  // namespace lacuna
