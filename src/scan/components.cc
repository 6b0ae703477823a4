#include "scan/components.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

#include "core/disjoint_sets.h"
#include "core/median.h"
#include "geometry/nearest.h"

namespace lacuna {
namespace {

constexpr size_t kShown = 3;  // components that are described

// Numbers the sets of the points by their total weight, the heaviest first, and sets of equal
// weight by their names. `set` is the name of each point's set, −1 for none.
Eigen::VectorXi NumberByWeight(const Eigen::VectorXi& set, const Eigen::VectorXd& weight) {
  std::map<int, double> total;
  for (Eigen::Index i = 0; i < set.size(); ++i) {
    if (set[i] >= 0) total[set[i]] += weight[i];
  }
  std::vector<int> order;
  for (const auto& [name, sum] : total) order.push_back(name);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return total[a] > total[b]; });
  std::map<int, int> number;
  for (size_t k = 0; k < order.size(); ++k) number[order[k]] = static_cast<int>(k);
  Eigen::VectorXi component = Eigen::VectorXi::Constant(set.size(), -1);
  for (Eigen::Index i = 0; i < set.size(); ++i) {
    if (set[i] >= 0) component[i] = number[set[i]];
  }
  return component;
}

// The width of the cubes through which points are connected.
double LinkLength(const Eigen::Matrix3Xd& points) {
  constexpr Eigen::Index kSample = 2000;
  const Eigen::Index step = points.cols() / kSample + 1;
  std::vector<Eigen::Index> some;
  for (Eigen::Index i = 0; i < points.cols(); i += step) some.push_back(i);
  const Eigen::Matrix3Xd sample = points(Eigen::all, some);
  const PointHits near = PointSearch(points).Nearest(sample, 2);
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::RowVectorXd row = sample.row(axis);
    middle[axis] = Median({row.begin(), row.end()});
  }
  const Eigen::RowVectorXd spacings = near.distance.row(1);
  const Eigen::RowVectorXd distances = (sample.colwise() - middle).colwise().norm();
  return std::max(4 * Median({spacings.begin(), spacings.end()}),
                  0.1 * Median({distances.begin(), distances.end()}));
}

using Cell = std::array<int64_t, 3>;
struct CellHash {
  size_t operator()(const Cell& cell) const {
    uint64_t hash = 0;
    for (const int64_t c : cell) hash = (hash ^ static_cast<uint64_t>(c)) * 0x9e3779b97f4a7c15u;
    return hash ^ hash >> 29;
  }
};

}  // namespace

Eigen::VectorXi ComponentsOfSurface(const TriMesh& surface) {
  const Eigen::Matrix3Xd& vertices = surface.vertices;
  DisjointSets sets(static_cast<size_t>(vertices.cols()));
  std::map<std::array<double, 3>, int> at_place;
  Eigen::VectorXd area = Eigen::VectorXd::Zero(vertices.cols());
  Eigen::VectorXi set = Eigen::VectorXi::Constant(vertices.cols(), -1);
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = surface.triangles.col(t);
    const Eigen::Matrix3d places = vertices(Eigen::all, corners);
    if (!places.allFinite()) continue;
    sets.Merge(corners[0], corners[1]);
    sets.Merge(corners[1], corners[2]);
    area[corners[0]] += (places.col(1) - places.col(0)).cross(places.col(2) - places.col(0)).norm();
    for (const int corner : corners) {
      if (set[corner] >= 0) continue;
      set[corner] = corner;
      const Eigen::Vector3d place = vertices.col(corner);
      sets.Merge(corner,
                 at_place.try_emplace({place.x(), place.y(), place.z()}, corner).first->second);
    }
  }
  for (int& s : set) {
    if (s >= 0) s = sets.Find(s);
  }
  return NumberByWeight(set, area);
}

Eigen::VectorXi ComponentsOfCloud(const Eigen::Matrix3Xd& points) {
  std::vector<Eigen::Index> finite;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (points.col(i).allFinite()) finite.push_back(i);
  }
  Eigen::VectorXi set = Eigen::VectorXi::Constant(points.cols(), -1);
  if (finite.empty()) return set;
  for (const Eigen::Index i : finite) set[i] = 0;
  if (finite.size() < 2) return set;
  const Eigen::Matrix3Xd known = points(Eigen::all, finite);
  const double length = LinkLength(known);
  if (!(length > 0)) return set;
  std::unordered_map<Cell, int, CellHash> cells;
  for (size_t k = 0; k < finite.size(); ++k) {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis) {
      cell[axis] = std::llround(std::floor(known(axis, static_cast<Eigen::Index>(k)) / length));
    }
    set[finite[k]] = cells.try_emplace(cell, static_cast<int>(cells.size())).first->second;
  }
  DisjointSets sets(cells.size());
  for (const auto& [cell, name] : cells) {
    for (int neighbour = 0; neighbour < 13; ++neighbour) {  // half of the 26: each pair once
      const auto found = cells.find({cell[0] + neighbour / 9 - 1, cell[1] + neighbour / 3 % 3 - 1,
                                     cell[2] + neighbour % 3 - 1});
      if (found != cells.end()) sets.Merge(name, found->second);
    }
  }
  for (const Eigen::Index i : finite) set[i] = sets.Find(set[i]);
  return NumberByWeight(set, Eigen::VectorXd::Ones(points.cols()));
}

std::string DescribeSmallComponents(const Eigen::Matrix3Xd& points,
                                    const Eigen::VectorXi& component, size_t fewest) {
  std::map<int, std::vector<Eigen::Index>> members;
  for (Eigen::Index i = 0; i < component.size(); ++i) {
    if (component[i] > 0) members[component[i]].push_back(i);
  }
  std::erase_if(members, [fewest](const auto& entry) { return entry.second.size() < fewest; });
  if (members.empty()) return "";
  std::string text =
      fmt::format("{} separate component{}: ", members.size(), members.size() == 1 ? "" : "s");
  size_t shown = 0;
  for (const auto& [number, own] : members) {
    if (shown == kShown) return text + "; …";
    const Eigen::Matrix3Xd part = points(Eigen::all, own);
    const Eigen::Vector3d centre = BoundingBox(part).center();
    text += fmt::format("{}{} points, {:.3g} mm across, around ({:.3g}, {:.3g}, {:.3g}) m",
                        shown++ > 0 ? "; " : "", own.size(), 1e3 * BoundingBoxDiagonal(part),
                        centre.x(), centre.y(), centre.z());
  }
  return text;
}

}  // namespace lacuna
