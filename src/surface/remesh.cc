#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/detect_features.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Surface_mesh.h>
#include <glog/logging.h>

#include <numbers>

#include "core/error.h"
#include "geometry/surface_check.h"
#include "surface/repair.h"
#include "surface/surface_mesh.h"

namespace lacuna {
namespace {

namespace processing = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

void RefuseUnlessManifold(const TriMesh& mesh) {
  SurfaceReport report = CheckSurface(mesh, false);
  if (report.triangles == 0) throw InputError("the surface to remesh has no triangles");
  if (report.IsManifold() && report.IsOriented() && report.degenerate_triangles.empty()) return;
  report.boundary_loops.clear();
  report.inside_out_components.clear();
  report.flat_components.clear();
  report.self_intersections_tested = true;
  throw InputError("the surface to remesh has " + DescribeFaults(report));
}

}  // namespace

TriMesh RemeshIsotropic(const TriMesh& mesh, const RemeshOptions& options) {
  CHECK_GT(options.edge_length, 0);
  RefuseUnlessManifold(mesh);
  SurfaceMesh surface = ToSurfaceMesh<SurfaceMesh>(mesh);
  auto is_sharp =
      surface.add_property_map<SurfaceMesh::Edge_index, bool>("e:is_sharp", false).first;
  if (options.feature_angle < std::numbers::pi) {
    processing::detect_sharp_edges(surface, options.feature_angle * 180 / std::numbers::pi,
                                   is_sharp);
  }
  processing::isotropic_remeshing(surface.faces(), options.edge_length, surface,
                                  CGAL::parameters::number_of_iterations(options.iterations)
                                      .number_of_relaxation_steps(3)
                                      .edge_is_constrained_map(is_sharp));
  surface.collect_garbage();
  return FromSurfaceMesh(surface);
}

}  // namespace lacuna
