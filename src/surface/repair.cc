#include "surface/repair.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "geometry/self_intersection.h"
#include "surface/surface_mesh.h"

namespace lacuna {
namespace {

namespace processing = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using SurfaceMesh = CGAL::Surface_mesh<Point>;
using Notes = std::vector<std::string>;

SurfaceMesh MeshFromSoup(const TriMesh& mesh, Notes& notes) {
  std::vector<Point> points;
  for (const auto v : mesh.vertices.colwise()) points.emplace_back(v.x(), v.y(), v.z());
  std::vector<std::array<size_t, 3>> triangles;
  for (const auto t : mesh.triangles.colwise()) {
    triangles.push_back(
        {static_cast<size_t>(t(0)), static_cast<size_t>(t(1)), static_cast<size_t>(t(2))});
  }
  processing::repair_polygon_soup(points, triangles);
  const auto report = [&](size_t now, Eigen::Index before, const char* what) {
    if (static_cast<Eigen::Index>(now) < before) {
      notes.push_back(fmt::format("removed {} {}", before - static_cast<Eigen::Index>(now), what));
    }
  };
  report(points.size(), mesh.vertices.cols(), "repeated or unused vertices");
  report(triangles.size(), mesh.triangles.cols(), "repeated or degenerate triangles");

  const size_t joined = points.size();
  processing::orient_polygon_soup(points, triangles);
  if (points.size() > joined) {
    notes.push_back(fmt::format("split the surface at {} non-manifold or misoriented vertices",
                                points.size() - joined));
  }
  SurfaceMesh surface;
  processing::polygon_soup_to_polygon_mesh(points, triangles, surface);
  return surface;
}

void KeepLargestComponent(SurfaceMesh& surface, Notes& notes) {
  auto component =
      surface.add_property_map<SurfaceMesh::Face_index, size_t>("f:component", 0).first;
  const size_t count = processing::connected_components(surface, component);
  if (count > 1) {
    std::vector<double> area(count, 0);
    for (const auto face : surface.faces()) {
      area[component[face]] += processing::face_area(face, surface);
    }
    const size_t largest = std::max_element(area.begin(), area.end()) - area.begin();
    const auto before = surface.number_of_faces();
    processing::keep_connected_components(surface, std::array{largest}, component);
    notes.push_back(fmt::format("removed {} small components with {} triangles", count - 1,
                                before - surface.number_of_faces()));
  }
  surface.remove_property_map(component);
}

// Caps are triangles with an angle above 160°; they are removed by edge flips. Needles have an edge
// ratio above 4; those shorter than a fifth of the mean edge are collapsed.
void RemoveSlivers(SurfaceMesh& surface, Notes& notes) {
  constexpr double kCapCosine = -0.94, kNeedleRatio = 4, kCollapsed = 0.2;
  const auto before = surface.number_of_faces();
  double length = 0;
  for (const auto edge : surface.edges()) length += processing::edge_length(edge, surface);
  const double collapsed = kCollapsed * length / std::max<double>(1, surface.number_of_edges());
  processing::remove_degenerate_faces(surface);
  processing::experimental::remove_almost_degenerate_faces(surface, kCapCosine, kNeedleRatio,
                                                           collapsed);
  if (surface.number_of_faces() != before) {
    notes.push_back(
        fmt::format("removed slivers: {} triangles became {}", before, surface.number_of_faces()));
  }
}

struct Hole {
  SurfaceMesh::Halfedge_index border;
  double perimeter;
};

std::vector<Hole> Holes(const SurfaceMesh& surface) {
  std::vector<SurfaceMesh::Halfedge_index> borders;
  processing::extract_boundary_cycles(surface, std::back_inserter(borders));
  std::vector<Hole> holes;
  for (const auto border : borders) {
    holes.push_back({border, processing::face_border_length(border, surface)});
  }
  std::stable_sort(holes.begin(), holes.end(),
                   [](const Hole& a, const Hole& b) { return a.perimeter > b.perimeter; });
  return holes;
}

void FillHoles(SurfaceMesh& surface, Notes& notes) {
  for (const Hole& hole : Holes(surface)) {
    std::vector<SurfaceMesh::Face_index> patch;
    std::vector<SurfaceMesh::Vertex_index> patch_vertices;
    const Point place = surface.point(surface.target(hole.border));
    processing::triangulate_and_refine_hole(surface, hole.border, std::back_inserter(patch),
                                            std::back_inserter(patch_vertices));
    if (patch.empty()) continue;
    notes.push_back(fmt::format("filled a hole of perimeter {:.4g} m at ({:.4g}, {:.4g}, {:.4g})",
                                hole.perimeter, place.x(), place.y(), place.z()));
  }
}

void RemoveSelfIntersections(SurfaceMesh& surface, Notes& notes) {
  surface.collect_garbage();
  const auto before = FindSelfIntersections(FromSurfaceMesh(surface));
  if (before.empty()) return;
  // If a large part of the surface intersects itself, a repair would take minutes and fail.
  constexpr double kHopeless = 0.05;
  if (static_cast<double>(before.size()) > kHopeless * surface.number_of_faces()) {
    notes.push_back(
        fmt::format("kept {} self-intersections, which are too many to repair", before.size()));
    return;
  }
  processing::experimental::remove_self_intersections(surface);
  surface.collect_garbage();
  const auto after = FindSelfIntersections(FromSurfaceMesh(surface));
  const Eigen::Vector3d& place = before.front().place;
  notes.push_back(
      fmt::format("removed {} of {} self-intersections, the first at ({:.4g}, {:.4g}, {:.4g})",
                  before.size() - std::min(before.size(), after.size()), before.size(), place.x(),
                  place.y(), place.z()));
}

void OrientOutward(SurfaceMesh& surface, Notes& notes) {
  if (surface.is_empty() || !CGAL::is_closed(surface)) return;
  const double before = processing::volume(surface);
  processing::orient_to_bound_a_volume(surface);
  if (before < 0) notes.push_back("reversed the orientation: the normals pointed inward");
}

}  // namespace

RepairedSurface RepairSurface(const TriMesh& mesh) {
  RepairedSurface repaired;
  SurfaceMesh surface = MeshFromSoup(mesh, repaired.notes);
  KeepLargestComponent(surface, repaired.notes);
  RemoveSlivers(surface, repaired.notes);
  FillHoles(surface, repaired.notes);
  RemoveSelfIntersections(surface, repaired.notes);
  OrientOutward(surface, repaired.notes);
  surface.collect_garbage();
  repaired.mesh = FromSurfaceMesh(surface);
  return repaired;
}

}  // namespace lacuna
