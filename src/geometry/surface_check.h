// Examination of a triangulated surface: whether it is closed, manifold, consistently oriented and
// free of self-intersections, and where it is not.
#ifndef LACUNA_GEOMETRY_SURFACE_CHECK_H_
#define LACUNA_GEOMETRY_SURFACE_CHECK_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "geometry/self_intersection.h"
#include "geometry/tri_mesh.h"

namespace lacuna {

// A connected set of boundary edges.
struct BoundaryLoop {
  Eigen::Vector3d centre;  // length-weighted mean, m
  double length = 0;       // m
  int edges = 0;
};

// The locations of faults (m): midpoints of edges, vertices or centroids of triangles.
using Places = std::vector<Eigen::Vector3d>;

struct SurfaceReport {
  Eigen::Index vertices = 0, triangles = 0;  // only vertices that triangles use
  Eigen::Index unused_vertices = 0;
  int components = 0;                        // sets of triangles that are connected by edges
  int euler_characteristic = 0;              // V − E + F
  std::vector<BoundaryLoop> boundary_loops;  // longest first
  Places nonmanifold_edges;                  // edges of three triangles or more
  Places nonmanifold_vertices;               // vertices at which several fans of triangles meet
  Places misoriented_edges;                  // edges whose two triangles have opposite orientations
  Places degenerate_triangles;               // triangles with a repeated vertex or no area
  Places inside_out_components;              // closed components of negative volume
  Places flat_components;                    // closed components without volume, up to rounding
  bool self_intersections_tested = false;
  std::vector<SelfIntersection> self_intersections;
  double area = 0;    // m²
  double volume = 0;  // signed, m³; meaningful only for a closed surface
  double min_edge = 0, mean_edge = 0, max_edge = 0;  // m
  double min_angle = 0;                              // smallest of all triangles, rad

  bool IsClosed() const { return triangles > 0 && boundary_loops.empty(); }
  bool IsManifold() const { return nonmanifold_edges.empty() && nonmanifold_vertices.empty(); }
  bool IsOriented() const { return misoriented_edges.empty(); }
  bool IsOutward() const {
    return IsClosed() && IsOriented() && inside_out_components.empty() && flat_components.empty();
  }
  bool IsFreeOfIntersections() const {
    return self_intersections_tested && self_intersections.empty();
  }
  // The surface encloses a body: all of the above, and no degenerate triangle.
  bool BoundsVolume() const {
    return IsManifold() && IsOutward() && IsFreeOfIntersections() && degenerate_triangles.empty();
  }
};

// Examines `mesh`, which may be any set of triangles with indices in range and finite vertices.
// Testing for self-intersections (exactly, with CGAL's predicates) takes by far the most time and
// may be omitted if only the topology matters.
SurfaceReport CheckSurface(const TriMesh& mesh, bool test_self_intersections = true);

// A description of the faults that keep the surface from bounding a volume, with the first
// locations of each: "2 holes, the longest of 0.031 m around (0.01, 0.2, 0.03); ...". Empty if
// there are none.
std::string DescribeFaults(const SurfaceReport& report);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_SURFACE_CHECK_H_
