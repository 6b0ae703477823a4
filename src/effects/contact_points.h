// The points of a body's boundary at which a contact law is evaluated: a quadrature of the boundary
// at rest.
//
// Linear elements: the boundary nodes, each with a third of the area of its faces, so that the
// tangent of a contact is block-diagonal. Quadratic elements: six points in each face, exact to
// degree 4 (G. Strang & G. Fix, An Analysis of the Finite Element Method, 1973; D. A. Dunavant,
// Int. J. Numer. Methods Eng. 21, 1985). A uniform pressure then gives the consistent nodal forces
// exactly, which are 0 at the corners of a straight face. No rule whose points are the nodes can do
// that with positive weights at all of them: with a third of the four flat triangles of the nodes,
// the stress below a uniform pressure is 7 % too high at corners and 8 % too low at midpoints, on
// every mesh.
#ifndef LACUNA_EFFECTS_CONTACT_POINTS_H_
#define LACUNA_EFFECTS_CONTACT_POINTS_H_

#include <Eigen/Core>
#include <array>
#include <vector>

#include "fem/body.h"

namespace lacuna {

// A material point on the boundary, x = Σ_k weight[k] x_node[k] over the first `count` entries.
struct ContactPoint {
  int count = 0;  // 1: a node; 6: a point of a quadratic face
  std::array<int, 6> node{};
  Eigen::Matrix<double, 6, 1> weight = Eigen::Matrix<double, 6, 1>::Zero();  // sum 1
  double area = 0;                                                           // m², at rest

  // The value at the point of a nodal vector field (3n, node-major).
  Eigen::Vector3d At(const Eigen::VectorXd& field) const {
    Eigen::Vector3d value = Eigen::Vector3d::Zero();
    for (size_t k = 0; k < static_cast<size_t>(count); ++k)
      value += weight[static_cast<Eigen::Index>(k)] * field.segment<3>(3 * node[k]);
    return value;
  }
};

// The areas sum to that of the boundary.
std::vector<ContactPoint> ContactPoints(const Body& body);

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_CONTACT_POINTS_H_
