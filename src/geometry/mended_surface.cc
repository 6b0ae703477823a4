#include "geometry/mended_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "geometry/component_volume.h"
#include "geometry/half_edges.h"
#include "geometry/used_indices.h"

namespace lacuna {
namespace {

using Eigen::Index;

// Two roundings of a number to six digits differ by at most this share of it.
constexpr double kSixDigits = 1e-5;

// For each vertex the first one with the same coordinates.
std::vector<int> FirstAtSamePlace(const Eigen::Matrix3Xd& vertices) {
  std::vector<int> order(static_cast<size_t>(vertices.cols())), first(order.size());
  std::iota(order.begin(), order.end(), 0);
  const auto place = [&](int v) {
    return std::tuple(vertices(0, v), vertices(1, v), vertices(2, v));
  };
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return place(a) != place(b) ? place(a) < place(b) : a < b; });
  for (size_t k = 0; k < order.size(); ++k) {
    const bool is_new = k == 0 || place(order[k]) != place(order[k - 1]);
    first[static_cast<size_t>(order[k])] =
        is_new ? order[k] : first[static_cast<size_t>(order[k - 1])];
  }
  return first;
}

Eigen::Matrix3Xi Renumbered(const Eigen::Matrix3Xi& triangles, const std::vector<int>& number) {
  return triangles.unaryExpr([&](int v) { return number[static_cast<size_t>(v)]; });
}

// Merges each vertex at an open edge with an earlier one that is nearer than `tolerance`, and
// returns how many were merged.
int MergeAtOpenEdges(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
                     double tolerance, std::vector<int>* first) {
  std::vector<char> is_open(first->size(), 0);
  const std::vector<HalfEdge> half_edges = SortedHalfEdges(Renumbered(triangles, *first));
  ForEachEdge(half_edges, [&](std::span<const HalfEdge> edge) {
    if (edge.size() != 1) return;
    for (const int v : {edge[0].low, edge[0].high}) is_open[static_cast<size_t>(v)] = 1;
  });
  // A vertex is at most one cube away from those that are nearer than the tolerance.
  using Cube = std::array<long long, 3>;
  std::map<Cube, std::vector<int>> cubes;
  std::vector<int> by_first(first->size());
  std::iota(by_first.begin(), by_first.end(), 0);
  int merged = 0;
  for (int v = 0; v < vertices.cols(); ++v) {
    if (!is_open[static_cast<size_t>(v)]) continue;
    Cube cube;
    for (int k = 0; k < 3; ++k)
      cube[static_cast<size_t>(k)] = std::llround(vertices(k, v) / tolerance);
    int found = -1;
    for (int at = 0; at < 27 && found < 0; ++at) {
      const auto near =
          cubes.find({cube[0] + at % 3 - 1, cube[1] + at / 3 % 3 - 1, cube[2] + at / 9 - 1});
      if (near == cubes.end()) continue;
      for (const int other : near->second)
        if ((vertices.col(other) - vertices.col(v)).norm() < tolerance) found = other;
    }
    if (found < 0)
      cubes[cube].push_back(v);
    else
      by_first[static_cast<size_t>(v)] = found;
    merged += found >= 0;
  }
  for (int& v : *first) v = by_first[static_cast<size_t>(v)];
  return merged;
}

// The triangles with three different corners that no earlier one has.
Eigen::Matrix3Xi DropDegenerateAndRepeated(const Eigen::Matrix3Xi& triangles,
                                           std::vector<std::string>* notes) {
  std::vector<std::pair<std::array<int, 3>, int>> corners;
  for (int t = 0; t < triangles.cols(); ++t) {
    std::array<int, 3> sorted{triangles(0, t), triangles(1, t), triangles(2, t)};
    std::sort(sorted.begin(), sorted.end());
    if (sorted[0] != sorted[1] && sorted[1] != sorted[2]) corners.emplace_back(sorted, t);
  }
  const Index degenerate = triangles.cols() - static_cast<Index>(corners.size());
  std::sort(corners.begin(), corners.end());
  const auto end = std::unique(corners.begin(), corners.end(),
                               [](const auto& a, const auto& b) { return a.first == b.first; });
  const Index repeated = corners.end() - end;
  corners.erase(end, corners.end());
  if (degenerate > 0)
    notes->push_back(fmt::format("dropped {} triangles with a repeated corner", degenerate));
  if (repeated > 0)
    notes->push_back(fmt::format("dropped {} triangles that repeat an earlier one", repeated));
  if (degenerate + repeated == 0) return triangles;
  std::vector<int> kept;
  for (const auto& [sorted, t] : corners) kept.push_back(t);
  std::sort(kept.begin(), kept.end());
  return triangles(Eigen::all, kept);
}

// The vertices that are used, and the triangles in their numbering.
void KeepUsedVertices(const TriMesh& given, const Eigen::Matrix3Xi& triangles,
                      MendedSurface* mended) {
  const UsedIndices vertices = FindUsedIndices(triangles, given.vertices.cols());
  mended->vertex_in_file = Eigen::Map<const Eigen::VectorXi>(
      vertices.used.data(), static_cast<Index>(vertices.used.size()));
  mended->mesh.vertices = given.vertices(Eigen::all, vertices.used);
  mended->mesh.triangles = vertices.Renumbered(triangles);
}

// Triangles that are connected by edges of two triangles.
struct SurfaceComponent {
  std::vector<int> triangles;
  std::vector<char> is_turned;  // whether the orientation differs from that of the first
  bool is_closed = true;
  bool is_two_sided = true;
  Eigen::AlignedBox3d box;
};

class OrientationMender {
 public:
  explicit OrientationMender(TriMesh* mesh) : mesh_(*mesh) {}

  void Run(std::vector<std::string>* notes) {
    FindComponents();
    Index turned = 0, inside_out = 0;
    for (SurfaceComponent& component : components_) {
      if (!component.is_two_sided) continue;
      const size_t size = component.triangles.size();
      if (2 * Count(component) > size) Reverse(&component);
      if (component.is_closed && IsInsideOut(component) && !IsWithinAnother(component))
        Reverse(&component);
      if (Count(component) == size)
        ++inside_out;
      else
        turned += static_cast<Index>(Count(component));
    }
    for (const SurfaceComponent& component : components_)
      for (size_t k = 0; k < component.triangles.size(); ++k)
        if (component.is_turned[k])
          std::swap(mesh_.triangles(1, component.triangles[k]),
                    mesh_.triangles(2, component.triangles[k]));
    if (turned > 0)
      notes->push_back(fmt::format(
          "turned {} of {} triangles, whose orientation differed from their neighbours'", turned,
          mesh_.triangles.cols()));
    if (inside_out > 0)
      notes->push_back(
          fmt::format("turned {} of {} components, which were inside out, so that their normals "
                      "point outward",
                      inside_out, components_.size()));
  }

 private:
  static size_t Count(const SurfaceComponent& component) {
    return static_cast<size_t>(
        std::count(component.is_turned.begin(), component.is_turned.end(), 1));
  }
  static void Reverse(SurfaceComponent* component) {
    for (char& turned : component->is_turned) turned = turned ? 0 : 1;
  }

  // A triangle beyond an edge that has two triangles.
  struct Neighbour {
    int triangle = -1;
    char is_opposite = 0;  // whether its orientation is the opposite one
  };
  using Neighbours = std::array<Neighbour, 3>;

  std::vector<Neighbours> NeighboursOfTriangles() const {
    std::vector<Neighbours> neighbours(static_cast<size_t>(mesh_.triangles.cols()));
    const auto add = [&](const HalfEdge& edge, const HalfEdge& twin) {
      for (Neighbour& slot : neighbours[static_cast<size_t>(edge.triangle)]) {
        if (slot.triangle >= 0) continue;
        slot = {twin.triangle, static_cast<char>(edge.forward == twin.forward)};
        return;
      }
    };
    const std::vector<HalfEdge> half_edges = SortedHalfEdges(mesh_.triangles);
    ForEachEdge(half_edges, [&](std::span<const HalfEdge> edge) {
      if (edge.size() != 2) return;
      add(edge[0], edge[1]);
      add(edge[1], edge[0]);
    });
    return neighbours;
  }

  void FindComponents() {
    const std::vector<Neighbours> neighbours = NeighboursOfTriangles();
    std::vector<char> is_found(neighbours.size(), 0), is_turned(neighbours.size(), 0);
    for (size_t seed = 0; seed < neighbours.size(); ++seed)
      if (!is_found[seed])
        components_.push_back(
            ComponentOf(static_cast<int>(seed), neighbours, &is_found, &is_turned));
  }

  // The component of the triangle `seed`, whose orientation is propagated to the others.
  SurfaceComponent ComponentOf(int seed, const std::vector<Neighbours>& neighbours,
                               std::vector<char>* is_found, std::vector<char>* is_turned) const {
    SurfaceComponent component;
    component.triangles.push_back(seed);
    (*is_found)[static_cast<size_t>(seed)] = 1;
    for (size_t k = 0; k < component.triangles.size(); ++k) {
      const auto t = static_cast<size_t>(component.triangles[k]);
      for (int corner = 0; corner < 3; ++corner)
        component.box.extend(Corner(component.triangles[k], corner));
      component.is_turned.push_back((*is_turned)[t]);
      for (const Neighbour& neighbour : neighbours[t]) {
        if (neighbour.triangle < 0) {
          component.is_closed = false;
          continue;
        }
        const auto other = static_cast<size_t>(neighbour.triangle);
        const auto expected = static_cast<char>((*is_turned)[t] ^ neighbour.is_opposite);
        if ((*is_found)[other]) {
          if ((*is_turned)[other] != expected) component.is_two_sided = false;
          continue;
        }
        (*is_found)[other] = 1;
        (*is_turned)[other] = expected;
        component.triangles.push_back(neighbour.triangle);
      }
    }
    if (!component.is_two_sided)
      std::fill(component.is_turned.begin(), component.is_turned.end(), 0);
    return component;
  }

  Eigen::Vector3d Corner(int triangle, int corner) const {
    return mesh_.vertices.col(mesh_.triangles(corner, triangle));
  }

  // Of a closed component, as it is turned.
  bool IsInsideOut(const SurfaceComponent& component) const {
    ComponentVolume volume(component.box);
    for (size_t k = 0; k < component.triangles.size(); ++k) {
      const int t = component.triangles[k];
      const int second = component.is_turned[k] ? 2 : 1;
      volume.Add(Corner(t, 0), Corner(t, second), Corner(t, 3 - second));
    }
    return volume.IsNegative();
  }

  bool IsWithinAnother(const SurfaceComponent& component) const {
    return std::any_of(components_.begin(), components_.end(), [&](const SurfaceComponent& other) {
      return &other != &component && other.is_closed && other.box.contains(component.box);
    });
  }

  TriMesh& mesh_;
  std::vector<SurfaceComponent> components_;
};

}  // namespace

MendedSurface MendSurface(const TriMesh& given, bool is_stl) {
  MendedSurface mended;
  const Index count = given.vertices.cols();
  std::vector<char> is_used(static_cast<size_t>(count), 0);
  for (const int v : given.triangles.reshaped()) is_used[static_cast<size_t>(v)] = 1;
  std::vector<int> first = FirstAtSamePlace(given.vertices);
  const auto merged = [&] {
    Index sum = 0;
    for (Index v = 0; v < count; ++v)
      sum += is_used[static_cast<size_t>(v)] && first[static_cast<size_t>(v)] != v;
    return sum;
  };
  if (is_stl && count > 0) {
    const double tolerance = kSixDigits * given.vertices.cwiseAbs().maxCoeff();
    if (const int near = tolerance > 0
                             ? MergeAtOpenEdges(given.vertices, given.triangles, tolerance, &first)
                             : 0;
        near > 0)
      mended.notes.push_back(
          fmt::format("merged {} vertices at open edges with others that are nearer than {:.2g}",
                      near, tolerance));
  } else if (merged() > 0) {
    mended.notes.push_back(
        fmt::format("merged {} of {} vertices with others at the same place", merged(), count));
  }
  KeepUsedVertices(
      given, DropDegenerateAndRepeated(Renumbered(given.triangles, first), &mended.notes), &mended);
  if (const Index unused = count - merged() - mended.mesh.vertices.cols(); unused > 0)
    mended.notes.push_back(fmt::format("dropped {} vertices that no triangle uses", unused));
  OrientationMender(&mended.mesh).Run(&mended.notes);
  return mended;
}

}  // namespace lacuna
