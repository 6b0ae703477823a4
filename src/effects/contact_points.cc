#include "effects/contact_points.h"

#include <Eigen/Geometry>

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

// The point with the barycentric coordinates l of a face of six nodes: the corners, then the
// midpoints of the edges (0, 1), (1, 2) and (2, 0).
ContactPoint OnQuadraticFace(const Body& body, Eigen::Index face, const Eigen::Vector3d& l,
                             double weight) {
  ContactPoint point;
  point.count = 6;
  // Two coordinates of the face are l[1] and l[2], with l[0] = 1 − l[1] − l[2].
  constexpr double kFirst[3] = {-1, 1, 0}, kSecond[3] = {-1, 0, 1};
  Eigen::Vector3d first = Eigen::Vector3d::Zero(), second = first;
  const auto add = [&](int k, double shape, double by_first, double by_second) {
    const int node = body.boundary.faces(k, face);
    point.node[static_cast<size_t>(k)] = node;
    point.weight[k] = shape;
    first += by_first * body.mesh.nodes.col(node);
    second += by_second * body.mesh.nodes.col(node);
  };
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    add(a, l[a] * (2 * l[a] - 1), (4 * l[a] - 1) * kFirst[a], (4 * l[a] - 1) * kSecond[a]);
    add(3 + a, 4 * l[a] * l[b], 4 * (l[a] * kFirst[b] + l[b] * kFirst[a]),
        4 * (l[a] * kSecond[b] + l[b] * kSecond[a]));
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
