#include "diagnosis/support_sides.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "effects/rest_region.h"

namespace lacuna {
namespace {

// A side of which a grip holds more than this share is gripped.
constexpr double kGrippedShare = 0.5;

std::optional<BodySide> SideFacing(int axis, double sign, const Body& body,
                                   const std::vector<char>& gripped) {
  BodySide side;
  side.name = std::string(sign < 0 ? "−" : "+") + "xyz"[axis];
  side.normal = sign * Eigen::Vector3d::Unit(axis);
  const Eigen::VectorXd areas = FacingAreas(side.normal, body);
  double held = 0;
  bool is_first = true;
  for (int i = 0; i < body.NodeCount(); ++i) {
    if (areas[i] == 0) continue;
    if (!gripped.empty() && gripped[static_cast<size_t>(i)] != 0) {
      held += areas[i];
      continue;
    }
    const Eigen::Vector3d place = body.mesh.nodes.col(i);
    side.low = is_first ? place : side.low.cwiseMin(place);
    side.high = is_first ? place : side.high.cwiseMax(place);
    is_first = false;
  }
  if (is_first || held > kGrippedShare * areas.sum()) return std::nullopt;
  side.longer = (axis + 1) % 3;
  side.shorter = (axis + 2) % 3;
  if (side.Length() < side.Width()) std::swap(side.longer, side.shorter);
  return side;
}

}  // namespace

std::vector<BodySide> SidesOf(const Body& body, const std::vector<char>& gripped) {
  std::vector<BodySide> sides;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1, 1})
      if (const auto side = SideFacing(axis, sign, body, gripped)) sides.push_back(*side);
  return sides;
}

Eigen::Vector3d PlaceOn(const BodySide& side, double along, double reach, const Body& body) {
  Eigen::Vector3d place = 0.5 * (side.low + side.high);
  place[side.longer] = along;
  const int across = 3 - side.longer - side.shorter;
  const Eigen::VectorXd areas = FacingAreas(side.normal, body);
  double weight = 0, height = 0;
  for (int i = 0; i < body.NodeCount(); ++i) {
    const double away = (body.mesh.nodes(side.longer, i) - along) / reach;
    const double near = areas[i] * std::exp(-0.5 * away * away);
    weight += near;
    height += near * body.mesh.nodes(across, i);
  }
  if (weight > 0) place[across] = height / weight;
  return place;
}

}  // namespace lacuna
