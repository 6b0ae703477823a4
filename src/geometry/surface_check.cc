#include "geometry/surface_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "core/disjoint_sets.h"
#include "core/first_few.h"
#include "geometry/component_volume.h"
#include "geometry/half_edges.h"

namespace lacuna {
namespace {

using Eigen::Vector3d;

// The corner of `triangle` at `vertex`, numbered as 3 · triangle + local corner.
int CornerAt(const TriMesh& mesh, int triangle, int vertex) {
  for (int k = 0; k < 2; ++k) {
    if (mesh.triangles(k, triangle) == vertex) return 3 * triangle + k;
  }
  return 3 * triangle + 2;
}

class Examination {
 public:
  explicit Examination(const TriMesh& mesh)
      : mesh_(mesh), corners_(3 * mesh.triangles.cols()), triangles_(mesh.triangles.cols()) {}

  SurfaceReport Run() {
    Edges();
    Vertices();
    Triangles();
    Components();
    return std::move(report_);
  }

 private:
  Vector3d Vertex(int v) const { return mesh_.vertices.col(v); }

  void Edges() {
    const std::vector<HalfEdge> half_edges = SortedHalfEdges(mesh_.triangles);
    std::vector<HalfEdge> boundary;
    double sum = 0;
    report_.min_edge = half_edges.empty() ? 0 : std::numeric_limits<double>::infinity();
    ForEachEdge(half_edges, [&](std::span<const HalfEdge> edge) {
      const HalfEdge& first = edge.front();
      ++edge_count_;
      const double length = (Vertex(first.high) - Vertex(first.low)).norm();
      sum += length;
      report_.min_edge = std::min(report_.min_edge, length);
      report_.max_edge = std::max(report_.max_edge, length);
      const Vector3d middle = 0.5 * (Vertex(first.low) + Vertex(first.high));
      for (const HalfEdge& other : edge.subspan(1))
        triangles_.Merge(first.triangle, other.triangle);
      if (edge.size() == 1) boundary.push_back(first);
      if (edge.size() > 2) report_.nonmanifold_edges.push_back(middle);
      if (edge.size() != 2) return;
      const HalfEdge& twin = edge[1];
      if (first.forward == twin.forward) report_.misoriented_edges.push_back(middle);
      for (const int v : {first.low, first.high}) {
        corners_.Merge(CornerAt(mesh_, first.triangle, v), CornerAt(mesh_, twin.triangle, v));
      }
    });
    if (edge_count_ > 0) report_.mean_edge = sum / edge_count_;
    BoundaryLoops(boundary);
  }

  void BoundaryLoops(const std::vector<HalfEdge>& boundary) {
    DisjointSets loops(mesh_.vertices.cols());
    for (const HalfEdge& edge : boundary) loops.Merge(edge.low, edge.high);
    std::vector<int> loop_of_vertex(mesh_.vertices.cols(), -1);
    for (const HalfEdge& edge : boundary) {
      has_boundary_.push_back(edge.triangle);
      int& loop = loop_of_vertex[loops.Find(edge.low)];
      if (loop < 0) {
        loop = static_cast<int>(report_.boundary_loops.size());
        report_.boundary_loops.push_back({Vector3d::Zero(), 0, 0});
      }
      BoundaryLoop& found = report_.boundary_loops[loop];
      const double length = (Vertex(edge.high) - Vertex(edge.low)).norm();
      found.centre += length * 0.5 * (Vertex(edge.low) + Vertex(edge.high));
      found.length += length;
      ++found.edges;
    }
    for (BoundaryLoop& loop : report_.boundary_loops) {
      if (loop.length > 0) loop.centre /= loop.length;
    }
    std::stable_sort(report_.boundary_loops.begin(), report_.boundary_loops.end(),
                     [](const auto& a, const auto& b) { return a.length > b.length; });
  }

  // A vertex is manifold when its corners form one fan.
  void Vertices() {
    std::vector<int> fans(mesh_.vertices.cols(), 0);
    for (int t = 0; t < mesh_.triangles.cols(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const int v = mesh_.triangles(k, t);
        if (corners_.Find(3 * t + k) == 3 * t + k) ++fans[v];
      }
    }
    for (int v = 0; v < mesh_.vertices.cols(); ++v) {
      if (fans[v] > 1) report_.nonmanifold_vertices.push_back(Vertex(v));
      ++(fans[v] > 0 ? report_.vertices : report_.unused_vertices);
    }
  }

  void Triangles() {
    report_.triangles = mesh_.triangles.cols();
    report_.area = TriangleAreas(mesh_).sum();
    report_.volume = EnclosedVolume(mesh_);
    report_.euler_characteristic =
        static_cast<int>(report_.vertices - edge_count_ + report_.triangles);
    report_.min_angle = report_.triangles > 0 ? std::numbers::pi : 0;
    for (int t = 0; t < mesh_.triangles.cols(); ++t) {
      const Vector3d a = Vertex(mesh_.triangles(0, t));
      const Vector3d b = Vertex(mesh_.triangles(1, t));
      const Vector3d c = Vertex(mesh_.triangles(2, t));
      const double twice_area = (b - a).cross(c - a).norm();
      if (!(twice_area > 0)) report_.degenerate_triangles.push_back((a + b + c) / 3);
      for (const double cosine_product :
           {(b - a).dot(c - a), (c - b).dot(a - b), (a - c).dot(b - c)}) {
        report_.min_angle = std::min(report_.min_angle, std::atan2(twice_area, cosine_product));
      }
    }
  }

  void Components() {
    // The triangles of each component, at the place of the one that represents it.
    std::vector<std::vector<int>> members(static_cast<size_t>(report_.triangles));
    for (int t = 0; t < report_.triangles; ++t) members[triangles_.Find(t)].push_back(t);
    std::vector<bool> is_open(members.size(), false);
    for (const int t : has_boundary_) is_open[triangles_.Find(t)] = true;
    for (size_t component = 0; component < members.size(); ++component) {
      if (members[component].empty()) continue;
      ++report_.components;
      if (!is_open[component]) ClosedComponent(members[component]);
    }
  }

  void ClosedComponent(const std::vector<int>& triangles) {
    Eigen::AlignedBox3d box;
    Vector3d centre = Vector3d::Zero();
    for (const int t : triangles) {
      for (const int v : mesh_.triangles.col(t)) {
        box.extend(Vertex(v));
        centre += Vertex(v);
      }
    }
    centre /= 3 * static_cast<double>(triangles.size());
    ComponentVolume volume(box);
    for (const int t : triangles)
      volume.Add(Vertex(mesh_.triangles(0, t)), Vertex(mesh_.triangles(1, t)),
                 Vertex(mesh_.triangles(2, t)));
    if (volume.IsFlat())
      report_.flat_components.push_back(centre);
    else if (volume.IsNegative())
      report_.inside_out_components.push_back(centre);
  }

  const TriMesh& mesh_;
  DisjointSets corners_, triangles_;
  std::vector<int> has_boundary_;  // triangles
  Eigen::Index edge_count_ = 0;
  SurfaceReport report_;
};

std::string Place(const Vector3d& place) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", place.x(), place.y(), place.z());
}

// "3 × non-manifold edge at (…), (…), (…)"
void DescribePlaces(const char* what, const Places& places, std::vector<std::string>* faults) {
  if (places.empty()) return;
  std::vector<std::string> shown;
  for (const Vector3d& place : places) shown.push_back(Place(place));
  faults->push_back(fmt::format("{} × {} at {}", places.size(), what, FirstFew(shown)));
}

}  // namespace

SurfaceReport CheckSurface(const TriMesh& mesh, bool test_self_intersections) {
  SurfaceReport report = Examination(mesh).Run();
  if (test_self_intersections) {
    report.self_intersections = FindSelfIntersections(mesh);
    report.self_intersections_tested = true;
  }
  return report;
}

std::string DescribeFaults(const SurfaceReport& report) {
  std::vector<std::string> faults;
  if (report.triangles == 0) faults.push_back("there are no triangles");
  if (!report.boundary_loops.empty()) {
    const BoundaryLoop& longest = report.boundary_loops.front();
    faults.push_back(fmt::format(
        "{} hole{}, the longest of {:.4g} m around {}", report.boundary_loops.size(),
        report.boundary_loops.size() > 1 ? "s" : "", longest.length, Place(longest.centre)));
  }
  DescribePlaces("edge of more than two triangles", report.nonmanifold_edges, &faults);
  DescribePlaces("non-manifold vertex", report.nonmanifold_vertices, &faults);
  DescribePlaces("edge between opposite orientations", report.misoriented_edges, &faults);
  DescribePlaces("triangle without area", report.degenerate_triangles, &faults);
  if (report.misoriented_edges.empty()) {
    DescribePlaces("component turned inside out", report.inside_out_components, &faults);
    DescribePlaces("closed component without volume", report.flat_components, &faults);
  }
  Places crossings;
  for (const SelfIntersection& crossing : report.self_intersections) {
    crossings.push_back(crossing.place);
  }
  DescribePlaces("self-intersection", crossings, &faults);
  if (!report.self_intersections_tested) faults.push_back("self-intersections were not tested");
  return fmt::format("{}", fmt::join(faults, "; "));
}

}  // namespace lacuna
