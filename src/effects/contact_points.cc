#include "effects/contact_points.h"

#include <Eigen/Geometry>

#include "geometry/face_shape_functions.h"

namespace lacuna {
namespace {

// The rule of degree 4: two orbits of three points, whose barycentric coordinates are one a and
// twice (1 − a)/2.
struct Orbit {
  double a, weight;  // the weights of all six points sum to 1
};
constexpr Orbit kOrbits[2] = {{0.816847572980458513, 0.109951743655321868},
                              {0.108103018168070227, 0.223381589678011466}};

std::vector<ContactPoint> NodesOfBoundary(const Body& body) {
  const Eigen::VectorXd areas = NodeBoundaryAreas(body);
  std::vector<ContactPoint> points;
  for (const int node : body.boundary.node) {
    ContactPoint& point = points.emplace_back();
    point.count = 1;
    point.node[0] = node;
    point.weight[0] = 1;
    point.area = areas[node];
  }
  return points;
}

// The point with these barycentric coordinates of a face of six nodes.
ContactPoint OnQuadraticFace(const Body& body, Eigen::Index face,
                             const Eigen::Vector3d& barycentric, double weight) {
  const FaceShape<6> shape = QuadraticFaceShape(barycentric);
  ContactPoint point;
  point.count = 6;
  point.weight = shape.value;
  Eigen::Vector3d first = Eigen::Vector3d::Zero(), second = first;
  for (const int k : {0, 3, 1, 4, 2, 5}) {
    const int node = body.boundary.faces(k, face);
    point.node[static_cast<size_t>(k)] = node;
    first += shape.by_first[k] * body.mesh.nodes.col(node);
    second += shape.by_second[k] * body.mesh.nodes.col(node);
  }
  point.area = 0.5 * weight * first.cross(second).norm();
  return point;
}

}  // namespace

std::vector<ContactPoint> ContactPoints(const Body& body) {
  if (body.mesh.Order() == 1) return NodesOfBoundary(body);
  std::vector<ContactPoint> points;
  for (Eigen::Index face = 0; face < body.boundary.faces.cols(); ++face)
    for (const Orbit& orbit : kOrbits)
      for (int corner = 0; corner < 3; ++corner) {
        Eigen::Vector3d l = Eigen::Vector3d::Constant((1 - orbit.a) / 2);
        l[corner] = orbit.a;
        points.push_back(OnQuadraticFace(body, face, l, orbit.weight));
      }
  return points;
}

}  // namespace lacuna
