#include "geometry/surface_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "core/disjoint_sets.h"
#include "core/first_few.h"

namespace lacuna {
namespace {

using Eigen::Vector3d;

// A triangle's edge from corner k to corner k + 1, as the pair of its vertices.
struct HalfEdge {
  int low, high;
  int triangle, corner;
  bool forward;  // whether it runs from the lower to the higher vertex index
  bool operator<(const HalfEdge& other) const {
    return std::tie(low, high, triangle, corner) <
           std::tie(other.low, other.high, other.triangle, other.corner);
  }
};

std::vector<HalfEdge> SortedHalfEdges(const TriMesh& mesh) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * mesh.triangles.cols());
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int from = mesh.triangles(k, t), to = mesh.triangles((k + 1) % 3, t);
      edges.push_back({std::min(from, to), std::max(from, to), t, k, from < to});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

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
    const std::vector<HalfEdge> edges = SortedHalfEdges(mesh_);
    std::vector<HalfEdge> boundary;
    double sum = 0;
    report_.min_edge = edges.empty() ? 0 : std::numeric_limits<double>::infinity();
    for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
      const HalfEdge& edge = edges[begin];
      while (end < edges.size() && edges[end].low == edge.low && edges[end].high == edge.high) {
        ++end;
      }
      ++edge_count_;
      const double length = (Vertex(edge.high) - Vertex(edge.low)).norm();
      sum += length;
      report_.min_edge = std::min(report_.min_edge, length);
      report_.max_edge = std::max(report_.max_edge, length);
      const Vector3d middle = 0.5 * (Vertex(edge.low) + Vertex(edge.high));
      for (size_t i = begin + 1; i < end; ++i) triangles_.Merge(edge.triangle, edges[i].triangle);
      if (end - begin == 1) boundary.push_back(edge);
      if (end - begin > 2) report_.nonmanifold_edges.push_back(middle);
      if (end - begin != 2) continue;
      const HalfEdge& twin = edges[begin + 1];
      if (edge.forward == twin.forward) report_.misoriented_edges.push_back(middle);
      for (const int v : {edge.low, edge.high}) {
        corners_.Merge(CornerAt(mesh_, edge.triangle, v), CornerAt(mesh_, twin.triangle, v));
      }
    }
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
    const Vector3d origin = report_.triangles > 0 ? BoundingBox(mesh_.vertices).center().eval()
                                                  : Vector3d::Zero().eval();
    const double reach = 0.5 * BoundingBoxDiagonal(mesh_.vertices);
    std::vector<double> volume(report_.triangles, 0), area(report_.triangles, 0);
    std::vector<Vector3d> centre(report_.triangles, Vector3d::Zero());
    std::vector<int> size(report_.triangles, 0);
    std::vector<bool> is_open(report_.triangles, false);
    for (int t = 0; t < report_.triangles; ++t) {
      const int component = triangles_.Find(t);
      const Vector3d a = Vertex(mesh_.triangles(0, t)) - origin;
      const Vector3d b = Vertex(mesh_.triangles(1, t)) - origin;
      const Vector3d c = Vertex(mesh_.triangles(2, t)) - origin;
      volume[component] += a.dot(b.cross(c)) / 6;
      area[component] += 0.5 * (b - a).cross(c - a).norm();
      centre[component] += (a + b + c) / 3 + origin;
      ++size[component];
    }
    for (const int t : has_boundary_) is_open[triangles_.Find(t)] = true;
    for (int t = 0; t < report_.triangles; ++t) {
      if (size[t] == 0) continue;
      ++report_.components;
      if (is_open[t]) continue;
      // A shift of the triangles by the rounding of their coordinates changes the volume by this.
      const double rounding = 8 * std::numeric_limits<double>::epsilon() * reach * area[t];
      if (std::abs(volume[t]) <= rounding) {
        report_.flat_components.push_back(centre[t] / size[t]);
      } else if (volume[t] < 0) {
        report_.inside_out_components.push_back(centre[t] / size[t]);
      }
    }
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
void DescribePlaces(const char* what, const Places& places, std::vector<std::string>& faults) {
  if (places.empty()) return;
  std::vector<std::string> shown;
  for (const Vector3d& place : places) shown.push_back(Place(place));
  faults.push_back(fmt::format("{} × {} at {}", places.size(), what, FirstFew(shown)));
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
  DescribePlaces("edge of more than two triangles", report.nonmanifold_edges, faults);
  DescribePlaces("non-manifold vertex", report.nonmanifold_vertices, faults);
  DescribePlaces("edge between opposite orientations", report.misoriented_edges, faults);
  DescribePlaces("triangle without area", report.degenerate_triangles, faults);
  if (report.misoriented_edges.empty()) {
    DescribePlaces("component turned inside out", report.inside_out_components, faults);
    DescribePlaces("closed component without volume", report.flat_components, faults);
  }
  Places crossings;
  for (const SelfIntersection& crossing : report.self_intersections) {
    crossings.push_back(crossing.place);
  }
  DescribePlaces("self-intersection", crossings, faults);
  if (!report.self_intersections_tested) faults.push_back("self-intersections were not tested");
  return fmt::format("{}", fmt::join(faults, "; "));
}

}  // namespace lacuna
