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
    // With u² alone the midpoint of the first edge would be at a quarter of it, where quadratic
    // elements are singular.
    constexpr double kUniform = 0.1;
    const Eigen::Vector3d share = kUniform * uvw + (1 - kUniform) * uvw.cwiseAbs2();
    const Eigen::Vector3d at = size.cwiseProduct(share);
    const double lower = at.head<2>().squaredNorm() / (2 * radius);
    return {at.x(), at.y(), at.z() + (1 - at.z() / size.z()) * lower};
  };
}

// The elliptical grid map of the square [−1, 1]² to the unit disc, x = a √(1 − b²/2) and
// y = b √(1 − a²/2). It is smooth, except that the corners of the square become flat.
BlockMap RoundBar(const Config& config) {
  const double radius = config.Quantity("radius", kLength, kPositive);
  const double length = config.Quantity("length", kLength, kPositive);
  return [radius, length](const Eigen::Vector3d& uvw) -> Eigen::Vector3d {
    const double a = 2 * uvw[0] - 1, b = 2 * uvw[1] - 1;
    return {radius * a * std::sqrt(1 - b * b / 2), radius * b * std::sqrt(1 - a * a / 2),
            length * uvw[2]};
  };
}

// A point of the meridian (r, z) of LE11, in m: between spheres of radius 1 and 1.4 about the
// origin, a taper, and a cylinder on top. The lower part ends where the inner sphere has the slope
// of 45° and the outer one the height of 0.7 m. `outwards` is 0 inside and 1 outside.
Eigen::Vector2d MeridianOfLe11(double outwards, double upwards) {
  const double inner_radius = std::sqrt(0.5), outer_angle = std::numbers::pi / 6;
  const Eigen::Vector2d taper_bottom(1.4 * std::cos(outer_angle), 0.7), taper_top(1, 1.39);
  Eigen::Vector2d inner, outer;
  if (upwards <= 0.5) {
    const double share = 2 * upwards, angle = share * std::numbers::pi / 4;
    inner = {std::cos(angle), std::sin(angle)};
    outer = 1.4 * Eigen::Vector2d(std::cos(share * outer_angle), std::sin(share * outer_angle));
  } else if (upwards <= 0.75) {
    const double share = 4 * (upwards - 0.5);
    inner = {inner_radius, (1 - share) * inner_radius + share * taper_top.y()};
    outer = (1 - share) * taper_bottom + share * taper_top;
  } else {
    const double height = taper_top.y() + 0.4 * 4 * (upwards - 0.75);
    inner = {inner_radius, height};
    outer = {taper_top.x(), height};
  }
  return (1 - outwards) * inner + outwards * outer;
}

BlockMap CylinderTaperSphere(const Config& /*config*/) {
  return [](const Eigen::Vector3d& uvw) -> Eigen::Vector3d {
    const Eigen::Vector2d meridian = MeridianOfLe11(uvw[0], uvw[2]);
    const double angle = 0.5 * std::numbers::pi * uvw[1];
    return {meridian.x() * std::cos(angle), meridian.x() * std::sin(angle), meridian.y()};
  };
}

}  // namespace

BlockMap ReadBlockMap(const Config& config) {
  using Reader = BlockMap (*)(const Config&);
  return config.Choice<Reader>("shape", {{"box", &Box},
                                         {"panel", &Panel},
                                         {"elliptic_plate", &EllipticPlate},
                                         {"paraboloid", &Paraboloid},
                                         {"round_bar", &RoundBar},
                                         {"cylinder_taper_sphere", &CylinderTaperSphere}})(config);
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
