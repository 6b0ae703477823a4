// The surface of a box with rounded edges, used as the soft bar of the synthetic scenes.
#ifndef LACUNA_GEOMETRY_ROUNDED_BOX_H_
#define LACUNA_GEOMETRY_ROUNDED_BOX_H_

#include <Eigen/Core>

#include "geometry/tri_mesh.h"

namespace lacuna {

// The box has the outer size `size` (m) and is centred at `centre`. Its edges are rounded with the
// radius `edge_radius` (m, at most half the shortest side; 0 gives sharp edges): it consists of all
// points within that distance of an inner box. Triangles have edges of about `edge_length` (m). The
// surface is closed, manifold and oriented outward. Sizes outside these ranges are programming
// errors (CHECK).
TriMesh RoundedBox(const Eigen::Vector3d& centre, const Eigen::Vector3d& size, double edge_radius,
                   double edge_length);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_ROUNDED_BOX_H_
