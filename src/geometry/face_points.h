// Material points on the boundary of a mesh, whose faces are curved where it is quadratic.
#ifndef LACUNA_GEOMETRY_FACE_POINTS_H_
#define LACUNA_GEOMETRY_FACE_POINTS_H_

#include <Eigen/Core>

#include "geometry/tet_mesh.h"

namespace lacuna {

// A place on face `face` of BoundarySurface::faces: x = Σ_a weight[a] · x_a over the face's nodes,
// with the derivatives of the weights by two coordinates of the face, the first turning into the
// second counter-clockwise seen from outside. Only the first `count` entries are used.
struct FacePoint {
  int face = -1;
  int count = 0;  // nodes of the face: 3 or 6
  Eigen::Matrix<double, 6, 1> weight, by_first, by_second;
};

// The place at these barycentric coordinates of triangle `triangle` of BoundarySurface::surface,
// four of which make up a quadratic face.
FacePoint PlaceOnFace(const BoundarySurface& boundary, int triangle,
                      const Eigen::Vector3d& barycentric);

// Where it lies, and the outward unit normal there, when the mesh nodes are at `nodes` (3 × n, m).
// The normal is 0 where the face is degenerate.
struct FaceGeometry {
  Eigen::Vector3d position, normal;
};
FaceGeometry Evaluate(const FacePoint& point, const BoundarySurface& boundary,
                      const Eigen::Ref<const Eigen::Matrix3Xd>& nodes);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_FACE_POINTS_H_
