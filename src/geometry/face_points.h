// Material points on the boundary of a mesh, whose faces are curved if the mesh is quadratic.
#ifndef LACUNA_GEOMETRY_FACE_POINTS_H_
#define LACUNA_GEOMETRY_FACE_POINTS_H_

#include <Eigen/Core>

#include "geometry/tet_mesh.h"

namespace lacuna {

// A point on one face of BoundarySurface::faces: x = Σ_a weight[a] · x_a over the face's nodes.
// `by_first` and `by_second` are the derivatives of the weights with respect to two coordinates of
// the face, whose directions are counter-clockwise seen from outside. Only the first `count`
// entries of the vectors are used.
struct FacePoint {
  int face = -1;
  int count = 0;  // nodes of the face: 3 or 6
  Eigen::Matrix<double, 6, 1> weight, by_first, by_second;
};

// The point with these barycentric coordinates (sum 1) in triangle `triangle` of
// BoundarySurface::surface, four of which make up a quadratic face. The index must be in range.
FacePoint PlaceOnFace(const BoundarySurface& boundary, int triangle,
                      const Eigen::Vector3d& barycentric);

// A point's position (m) and the outward unit normal there; the normal is 0 on a degenerate face.
struct FaceGeometry {
  Eigen::Vector3d position, normal;
};
// Evaluates `point` for the node positions `nodes` (3 × n, m).
FaceGeometry Evaluate(const FacePoint& point, const BoundarySurface& boundary,
                      const Eigen::Ref<const Eigen::Matrix3Xd>& nodes);

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_FACE_POINTS_H_
