// Arrows as a surface, so that they can be drawn and coloured like one.
#ifndef LACUNA_REPORT_ARROW_MESH_H_
#define LACUNA_REPORT_ARROW_MESH_H_

#include <Eigen/Core>

#include "geometry/tri_mesh.h"

namespace lacuna {

// An arrow from each column of `from` along the same column of `along` (both 3 × n, m): a prism of
// `radius` (m) and a cone of three times that, together kArrowVertices vertices each, in order. One
// shorter than its cone is drawn as a cone alone; one without length as a point.
inline constexpr int kArrowVertices = 25;
TriMesh ArrowMesh(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& along, double radius);

}  // namespace lacuna

#endif  // LACUNA_REPORT_ARROW_MESH_H_
