#include "geometry/sheet.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <array>

#include "core/error.h"
#include "geometry/surface_check.h"

namespace lacuna {
namespace {

void RefuseUnlessOpenSheet(const TriMesh& sheet) {
  SurfaceReport report = CheckSurface(sheet, false);
  if (report.IsClosed()) throw InputError("the sheet to thicken is closed; expected an open sheet");
  if (report.unused_vertices > 0) {
    throw InputError(fmt::format("{} vertices of the sheet to thicken belong to no triangle",
                                 report.unused_vertices));
  }
  // A boundary is expected in an open sheet, and intersections will show as inverted prisms.
  report.boundary_loops.clear();
  report.inside_out_components.clear();
  report.flat_components.clear();
  report.self_intersections_tested = true;
  const std::string faults = DescribeFaults(report);
  if (!faults.empty()) throw InputError("the sheet to thicken has " + faults);
}

// The height of the lowest level above the sheet, as a multiple of the thickness.
double LowestLevel(SheetPosition position) {
  switch (position) {
    case SheetPosition::kMiddle:
      return -0.5;
    case SheetPosition::kTop:
      return -1;
    case SheetPosition::kBottom:
      return 0;
  }
  LOG(FATAL) << "no such position";
}

// The three tetrahedra of the prism over corners with the numbers a < b < c. Their volumes are
// positive if the corners are counter-clockwise seen from above.
std::array<std::array<int, 4>, 3> PrismTets(std::array<int, 3> corners, int lower, int upper) {
  std::sort(corners.begin(), corners.end());
  const auto& [a, b, c] = corners;
  return {{{a + lower, b + lower, c + lower, c + upper},
           {a + lower, b + lower, c + upper, b + upper},
           {a + lower, a + upper, b + upper, c + upper}}};
}

}  // namespace

TetMesh ThickenToTets(const TriMesh& sheet, double thickness, int layers, SheetPosition position) {
  CHECK(thickness > 0 && layers >= 1);
  RefuseUnlessOpenSheet(sheet);
  const int vertex_count = static_cast<int>(sheet.vertices.cols());
  const int triangle_count = static_cast<int>(sheet.triangles.cols());
  const Eigen::Matrix3Xd normals = VertexNormals(sheet);

  TetMesh mesh{Eigen::Matrix3Xd(3, vertex_count * (layers + 1)),
               Eigen::MatrixXi(4, 3 * triangle_count * layers)};
  for (int level = 0; level <= layers; ++level) {
    const double height = thickness * (LowestLevel(position) + static_cast<double>(level) / layers);
    mesh.nodes.middleCols(level * vertex_count, vertex_count) = sheet.vertices + height * normals;
  }
  for (int t = 0; t < triangle_count; ++t) {
    const std::array<int, 3> corners{sheet.triangles(0, t), sheet.triangles(1, t),
                                     sheet.triangles(2, t)};
    // Sorting the corners by number reverses the triangle if the permutation is odd.
    const bool turned =
        (corners[0] < corners[1]) + (corners[1] < corners[2]) + (corners[2] < corners[0]) == 1;
    for (int layer = 0; layer < layers; ++layer) {
      const auto tets = PrismTets(corners, layer * vertex_count, (layer + 1) * vertex_count);
      for (int k = 0; k < 3; ++k) {
        auto tet = mesh.tets.col(3 * (layer * triangle_count + t) + k);
        tet = Eigen::Map<const Eigen::Vector4i>(tets[k].data());
        if (turned) std::swap(tet(0), tet(1));
      }
    }
  }
  const Eigen::VectorXd volumes = TetVolumes(mesh);
  Eigen::Index smallest = 0;
  if (!(volumes.minCoeff(&smallest) > 0)) {
    const Eigen::Vector3d place = sheet.vertices.col(mesh.tets(0, smallest) % vertex_count);
    throw InputError(fmt::format(
        "the sheet bends too sharply for a thickness of {:.4g} m at ({:.4g}, {:.4g}, {:.4g}): its "
        "two sides would cross",
        thickness, place.x(), place.y(), place.z()));
  }
  return mesh;
}

}  // namespace lacuna
