// A body at rest, discretised: nodes, elements, quadrature, mass, boundary. Knows no physics.
#ifndef LACUNA_FEM_BODY_H_
#define LACUNA_FEM_BODY_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "fem/block_matrix.h"
#include "fem/element_schedule.h"
#include "geometry/tet_mesh.h"

namespace lacuna {

struct Body {
  // Rest shape, m. Nodes are numbered as in the mesh that was given; elements are sorted by place
  // (element_schedule.h), and `given_element` holds their numbers there.
  TetMesh mesh;
  std::vector<int> given_element;
  BoundarySurface boundary;
  double density = 0;  // kg/m³

  // Quadrature: 1 point per linear tet, 4 per quadratic tet (exact to degree 2). Point p of element
  // e is q = e·points_per_element + p.
  int points_per_element = 0;
  Eigen::Matrix3Xd point;          // 3 × points: rest position, m
  Eigen::VectorXd weight;          // points: volume that each stands for, m³
  Eigen::MatrixXd shape_gradient;  // (nodes per element) × (3·points): ∂N/∂X, 1/m; columns 3q…3q+2

  Eigen::VectorXd node_mass;  // lumped (HRZ for quadratic), kg; sums to density·volume

  std::shared_ptr<const BlockPattern> pattern;
  std::shared_ptr<const ElementSchedule> schedule;  // how elements add into shared arrays

  int NodeCount() const { return static_cast<int>(mesh.NodeCount()); }
  int ElementCount() const { return static_cast<int>(mesh.TetCount()); }
  int PointCount() const { return ElementCount() * points_per_element; }
};

// Throws InputError when the mesh is empty, names a node that is not there, has an element without
// positive volume (at a quadrature point of a curved one) or a node without element, or when the
// density is not positive.
Body MakeBody(const TetMesh& mesh, double density);

// Boundary area around each node (n, m²; 0 inside): a third of each boundary triangle's, the four
// that a quadratic face is split into counting as triangles.
Eigen::VectorXd NodeBoundaryAreas(const Body& body);

// An element that is inside out or flat (det ∂x/∂X ≤ 0 at a quadrature point) when the nodes are at
// `position` (3n), by its number in the mesh that was given; −1 when there is none.
int FindInvertedElement(const Body& body, const Eigen::VectorXd& position);

}  // namespace lacuna

#endif  // LACUNA_FEM_BODY_H_
