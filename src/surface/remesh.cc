#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Surface_mesh.h>
#include <glog/logging.h>

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

TriMesh RemeshIsotropic(const TriMesh& mesh, double edge_length) {
  constexpr int kPasses = 4;  // more: more uniform triangles, in proportionally more time
  CHECK_GT(edge_length, 0);
  RefuseUnlessManifold(mesh);
  SurfaceMesh surface = ToSurfaceMesh<SurfaceMesh>(mesh);
  processing::isotropic_remeshing(
      surface.faces(), edge_length, surface,
      CGAL::parameters::number_of_iterations(kPasses).number_of_relaxation_steps(3));
  surface.collect_garbage();
  return FromSurfaceMesh(surface);
}

}  // namespace lacuna
