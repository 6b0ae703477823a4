#include "geometry/face_points.h"

#include <Eigen/Geometry>

#include "geometry/face_shape_functions.h"

namespace lacuna {
namespace {

template <int kNodes>
void SetShape(const FaceShape<kNodes>& shape, FacePoint* point) {
  point->count = kNodes;
  point->weight.head<kNodes>() = shape.value;
  point->by_first.head<kNodes>() = shape.by_first;
  point->by_second.head<kNodes>() = shape.by_second;
}

}  // namespace

FacePoint PlaceOnFace(const BoundarySurface& boundary, int triangle,
                      const Eigen::Vector3d& barycentric) {
  FacePoint point;
  point.weight.setZero();
  point.by_first.setZero();
  point.by_second.setZero();
  if (boundary.faces.rows() == 3) {
    point.face = triangle;
    SetShape(LinearFaceShape(barycentric), &point);
    return point;
  }
  point.face = triangle / 4;
  const Eigen::Matrix<double, 3, 6> nodes = FaceNodeCoordinates();
  Eigen::Vector3d in_face = Eigen::Vector3d::Zero();
  for (int corner = 0; corner < 3; ++corner)
    in_face += barycentric[corner] * nodes.col(kFaceQuarters[triangle % 4][corner]);
  SetShape(QuadraticFaceShape(in_face), &point);
  return point;
}

FaceGeometry Evaluate(const FacePoint& point, const BoundarySurface& boundary,
                      const Eigen::Ref<const Eigen::Matrix3Xd>& nodes) {
  Eigen::Vector3d position = Eigen::Vector3d::Zero(), first = position, second = position;
  for (int a = 0; a < point.count; ++a) {
    const Eigen::Vector3d node = nodes.col(boundary.faces(a, point.face));
    position += point.weight[a] * node;
    first += point.by_first[a] * node;
    second += point.by_second[a] * node;
  }
  const Eigen::Vector3d normal = first.cross(second);
  const double length = normal.norm();
  return {position, length > 0 ? Eigen::Vector3d(normal / length) : Eigen::Vector3d::Zero()};
}

}  // namespace lacuna
