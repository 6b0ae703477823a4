// Cutting of a polygon into triangles.
#ifndef LACUNA_GEOMETRY_POLYGON_TRIANGLES_H_
#define LACUNA_GEOMETRY_POLYGON_TRIANGLES_H_

#include <Eigen/Core>
#include <array>
#include <vector>

namespace lacuna {

// The n − 2 triangles of a polygon with the corners `corners` (3 × n, n ≥ 3, of absolute value up
// to 1e100), as indices of corners, with the orientation of the polygon. A polygon all of whose
// corners are seen from the first one is cut into a fan around it. Any other is cut by clipping
// ears in the plane normal to its area vector (Meisters, Am. Math. Mon. 82, 1975), which takes
// O(n²). A polygon without area or with edges that cross is cut into the fan, too, which
// CheckSurface then finds fault with.
std::vector<std::array<int, 3>> CutPolygon(const Eigen::Matrix3Xd& corners);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_POLYGON_TRIANGLES_H_
