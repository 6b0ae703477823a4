// The surface of a box with rounded edges: the soft bar of the synthetic scenes.
#ifndef LACUNA_GEOMETRY_ROUNDED_BOX_H_
#define LACUNA_GEOMETRY_ROUNDED_BOX_H_

#include <Eigen/Core>

#include "geometry/tri_mesh.h"

namespace lacuna {

// All points within `edge_radius` (m, at most half the shortest side; 0: sharp edges) of an inner
// box, so that the outer size is `size` (m), centred at `centre`. Triangles have edges of about
// `edge_length` (m). Closed, manifold, outward.
TriMesh RoundedBox(const Eigen::Vector3d& centre, const Eigen::Vector3d& size, double edge_radius,
                   double edge_length);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_ROUNDED_BOX_H_
