// Giving an open sheet a thickness, as a closed surface or as a tetrahedral mesh.
#ifndef LACUNA_GEOMETRY_SHEET_H_
#define LACUNA_GEOMETRY_SHEET_H_

#include "geometry/tet_mesh.h"
#include "geometry/tri_mesh.h"

namespace lacuna {

// The position of the sheet in the thickened body: it becomes the middle, the top or the bottom
// surface. The sheet's normals point to the top.
enum class SheetPosition { kMiddle, kTop, kBottom };

// The closed surface of a thickened sheet with n vertices: vertex v + k·n belongs to vertex v of
// the sheet and lies on the bottom for k = 0 and on the top for k = 1.
struct ThickSheet {
  TriMesh surface;
  Eigen::VectorXi origin;  // 2n: the vertex of the sheet for each vertex of `surface`
};

// Offsets copies of the sheet along its vertex normals, `thickness` (m) apart, and closes the rim.
// The sheet must be manifold, consistently oriented, open, and thin compared with its radius of
// curvature. Throws InputError with the fault and its location if the sheet is not manifold, is not
// oriented or is closed, if a vertex belongs to no triangle, or if a prism over one of its
// triangles would be inverted. `thickness` must be positive (CHECK).
ThickSheet ThickenSheet(const TriMesh& sheet, double thickness,
                        SheetPosition position = SheetPosition::kMiddle);

// The same body as `layers` ≥ 1 layers of prisms, each split into three linear tetrahedra. Node
// v + k·n belongs to vertex v on level k = 0..layers, counted from the bottom. Diagonals start at
// the vertex of lower number, so that neighbouring prisms agree. Throws like ThickenSheet.
TetMesh ThickenToTets(const TriMesh& sheet, double thickness, int layers,
                      SheetPosition position = SheetPosition::kMiddle);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_SHEET_H_
