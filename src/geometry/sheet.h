// An open sheet with a thickness: a closed surface, or prisms split into tetrahedra.
#ifndef LACUNA_GEOMETRY_SHEET_H_
#define LACUNA_GEOMETRY_SHEET_H_

#include "geometry/tet_mesh.h"
#include "geometry/tri_mesh.h"

namespace lacuna {

// Where the material lies as seen from the sheet, whose normals point "above".
enum class SheetPosition { kMiddle, kTop, kBottom };

// The closed surface of a sheet. Vertex v + k·n stands over vertex v of the sheet's n vertices,
// below it for k = 0 and above for k = 1.
struct ThickSheet {
  TriMesh surface;
  Eigen::VectorXi origin;  // the sheet's vertex for each of the 2n
};

// Moves copies of the sheet along its vertex normals, `thickness` (m) apart, and closes the side.
// The sheet must be manifold, consistently oriented, open, and thin against its radius of
// curvature. Throws InputError with the fault and its place where it is not manifold or oriented,
// where it is closed, and where a prism over one of its triangles would turn over.
ThickSheet ThickenSheet(const TriMesh& sheet, double thickness,
                        SheetPosition position = SheetPosition::kMiddle);

// The same body as `layers` layers of prisms, each split into three tetrahedra. Node v + k·n stands
// over vertex v on level k = 0..layers, counted from below. The diagonals run from the vertex of
// lower number, so that prisms side by side agree. Linear; throws as ThickenSheet does.
TetMesh ThickenToTets(const TriMesh& sheet, double thickness, int layers,
                      SheetPosition position = SheetPosition::kMiddle);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_SHEET_H_
