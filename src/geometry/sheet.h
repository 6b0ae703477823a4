// Giving an open sheet a thickness, as a tetrahedral mesh.
#ifndef LACUNA_GEOMETRY_SHEET_H_
#define LACUNA_GEOMETRY_SHEET_H_

#include "geometry/tet_mesh.h"
#include "geometry/tri_mesh.h"

namespace lacuna {

// The position of the sheet in the thickened body: it becomes the middle, the top or the bottom
// surface. The sheet's normals point to the top.
enum class SheetPosition { kMiddle, kTop, kBottom };

// Offsets copies of the sheet along its vertex normals, `thickness` (m) apart in all, and fills the
// space between them with `layers` ≥ 1 layers of prisms, each split into three linear tetrahedra.
// Node v + k·n belongs to vertex v of the sheet's n on level k = 0..layers, counted from the
// bottom. Diagonals start at the vertex of lower number, so that neighbouring prisms agree. The
// sheet must be manifold, consistently oriented, open, and thin compared with its radius of
// curvature. Throws InputError with the fault and its location if the sheet is not manifold, is not
// oriented or is closed, if a vertex belongs to no triangle, or if a prism over one of its
// triangles would be inverted. `thickness` must be positive (CHECK).
TetMesh ThickenToTets(const TriMesh& sheet, double thickness, int layers,
                      SheetPosition position = SheetPosition::kMiddle);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_SHEET_H_
