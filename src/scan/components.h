// The separate parts of a scanned surface or cloud: the object, and debris beside it.
#ifndef LACUNA_SCAN_COMPONENTS_H_
#define LACUNA_SCAN_COMPONENTS_H_

#include <Eigen/Core>
#include <string>

#include "geometry/tri_mesh.h"

namespace lacuna {

// The component of each vertex or point, numbered from 0, the largest first, and among equally
// large ones that of the first vertex or point; −1 for points that are not finite and vertices
// without a triangle. Components of a surface are connected by triangles,
// of which vertices at equal places count as one, and compared by area. Components of a cloud are
// connected through cubes of a grid that touch, whose width is four times the spacing of the points
// and at least a tenth of their median distance from their middle, and compared by their number of
// points.
Eigen::VectorXi ComponentsOfSurface(const TriMesh& surface);
Eigen::VectorXi ComponentsOfCloud(const Eigen::Matrix3Xd& points);

// The components beside the largest, with the number of points, size and place of the first of
// them: "2 separate components: 20 points, 4.2 mm across, around (0.1, 0.2, 0.05) m; …". Components
// of fewer than `fewest` points are left out. Empty where there are none.
std::string DescribeSmallComponents(const Eigen::Matrix3Xd& points,
                                    const Eigen::VectorXi& component, size_t fewest);

}  // namespace lacuna

#endif  // LACUNA_SCAN_COMPONENTS_H_
