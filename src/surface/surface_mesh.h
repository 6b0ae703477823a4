// Conversion between TriMesh and a halfedge mesh with the interface of CGAL::Surface_mesh.
//
// The type is a template parameter, so that this header does not depend on CGAL.
#ifndef LACUNA_SURFACE_SURFACE_MESH_H_
#define LACUNA_SURFACE_SURFACE_MESH_H_

#include <vector>

#include "geometry/tri_mesh.h"

namespace lacuna {

// Converts to a halfedge mesh. `mesh` must be manifold and consistently oriented; otherwise
// triangles are missing in the result. The vertices keep their indices.
template <typename SurfaceMesh>
SurfaceMesh ToSurfaceMesh(const TriMesh& mesh) {
  using Vertex = typename SurfaceMesh::Vertex_index;
  SurfaceMesh result;
  for (const auto v : mesh.vertices.colwise()) {
    result.add_vertex(typename SurfaceMesh::Point(v.x(), v.y(), v.z()));
  }
  for (const auto t : mesh.triangles.colwise()) {
    result.add_face(Vertex(t(0)), Vertex(t(1)), Vertex(t(2)));
  }
  return result;
}

// Converts from a halfedge mesh. Vertices without triangles are omitted; the others keep their
// order.
template <typename SurfaceMesh>
TriMesh FromSurfaceMesh(const SurfaceMesh& surface) {
  std::vector<int> number(surface.number_of_vertices() + surface.number_of_removed_vertices(), -1);
  TriMesh mesh{Eigen::Matrix3Xd(3, surface.number_of_vertices()),
               Eigen::Matrix3Xi(3, surface.number_of_faces())};
  int vertex_count = 0;
  for (const auto v : surface.vertices()) {
    if (surface.is_isolated(v)) continue;
    const auto& point = surface.point(v);
    mesh.vertices.col(vertex_count) << point.x(), point.y(), point.z();
    number[v] = vertex_count++;
  }
  mesh.vertices.conservativeResize(3, vertex_count);
  int triangle = 0;
  for (const auto face : surface.faces()) {
    int corner = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(face))) {
      mesh.triangles(corner++, triangle) = number[v];
    }
    ++triangle;
  }
  return mesh;
}

}  // namespace lacuna

#endif  // LACUNA_SURFACE_SURFACE_MESH_H_
