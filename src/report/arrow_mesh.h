// Arrows as a surface mesh, so that they can be drawn and coloured like any other surface.
#ifndef LACUNA_REPORT_ARROW_MESH_H_
#define LACUNA_REPORT_ARROW_MESH_H_

#include <Eigen/Core>

#include "geometry/tri_mesh.h"

namespace lacuna {

// Makes an arrow from each column of `from` along the same column of `along` (both 3 × n, m). It
// consists of a prism of radius `radius` (m) and a cone of three times that radius, and has
// kArrowVertices vertices; those of successive arrows follow one another. An arrow shorter than its
// cone is drawn as a cone alone, and one of length 0 as a point.
inline constexpr int kArrowVertices = 25;
TriMesh ArrowMesh(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& along, double radius);

}  // namespace lacuna

#endif  // LACUNA_REPORT_ARROW_MESH_H_
