// What a triangulated surface is: closed, manifold, oriented, free of self-intersections; and where
// it is not.
#ifndef LACUNA_GEOMETRY_SURFACE_CHECK_H_
#define LACUNA_GEOMETRY_SURFACE_CHECK_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "geometry/tri_mesh.h"

namespace lacuna {

// Boundary edges that hang together.
struct BoundaryLoop {
  Eigen::Vector3d centre;  // mean over the length, m
  double length = 0;       // m
  int edges = 0;
};

// Two triangles that meet elsewhere than in the vertices they share.
struct SelfIntersection {
  int first = -1, second = -1;  // triangles, first < second
  Eigen::Vector3d place;        // the middle of their common bounding box, m
};

// A fault at a place: an edge's midpoint, a vertex or a triangle's centroid.
using Places = std::vector<Eigen::Vector3d>;

struct SurfaceReport {
  Eigen::Index vertices = 0, triangles = 0;  // vertices that triangles use
  Eigen::Index unused_vertices = 0;
  int components = 0;                        // triangles that hang together by edges
  int euler_characteristic = 0;              // V − E + F
  std::vector<BoundaryLoop> boundary_loops;  // longest first
  Places nonmanifold_edges;                  // shared by three triangles or more
  Places nonmanifold_vertices;               // where several fans of triangles touch
  Places misoriented_edges;                  // whose two triangles turn opposite ways
  Places degenerate_triangles;               // repeated vertices or no area at all
  Places inside_out_components;              // closed, with a negative volume
  bool self_intersections_tested = false;
  std::vector<SelfIntersection> self_intersections;
  double area = 0;    // m²
  double volume = 0;  // signed, m³; has a meaning only for a closed surface
  double min_edge = 0, mean_edge = 0, max_edge = 0;  // m
  double min_angle = 0;                              // smallest of all triangles, rad

  bool IsClosed() const { return triangles > 0 && boundary_loops.empty(); }
  bool IsManifold() const { return nonmanifold_edges.empty() && nonmanifold_vertices.empty(); }
  bool IsOriented() const { return misoriented_edges.empty(); }
  bool IsOutward() const { return IsClosed() && IsOriented() && inside_out_components.empty(); }
  bool IsFreeOfIntersections() const {
    return self_intersections_tested && self_intersections.empty();
  }
  // The surface encloses a body: all of the above, and no degenerate triangle.
  bool BoundsVolume() const {
    return IsManifold() && IsOutward() && IsFreeOfIntersections() && degenerate_triangles.empty();
  }
};

// Examines `mesh`, any soup of triangles with indices in range and finite vertices. Intersections
// are decided exactly (CGAL's predicates); they are by far the dearest part, so a caller who needs
// only the topology leaves them out.
SurfaceReport CheckSurface(const TriMesh& mesh, bool test_self_intersections = true);

// What keeps the surface from bounding a volume, with the first places of each fault; empty when
// nothing does: "2 holes, the longest of 0.031 m around (0.01, 0.2, 0.03); ...".
std::string DescribeFaults(const SurfaceReport& report);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_SURFACE_CHECK_H_
