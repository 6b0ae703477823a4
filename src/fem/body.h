// The finite-element discretisation of a body in its reference configuration, without any physics.
//
// Nodes and elements of the rest shape, the quadrature over its volume, the lumped masses and the
// boundary. Point q of the quadrature contributes w_q to ∫ dV, and ∂N_a/∂X at it maps nodal values
// to gradients. Lengths are in m, masses in kg.
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
  // The rest shape. Nodes have the numbers of the mesh that was given; elements are sorted along a
  // space-filling curve (element_schedule.h), and `given_element` holds their original numbers.
  TetMesh mesh;
  std::vector<int> given_element;
  BoundarySurface boundary;
  double density = 0;  // kg/m³

  // Quadrature with 1 point per linear tetrahedron and 4 per quadratic one (exact to degree 2).
  // Point p of element e has the number q = e·points_per_element + p.
  int points_per_element = 0;
  Eigen::Matrix3Xd point;          // 3 × points: position in the rest shape, m
  Eigen::VectorXd weight;          // points: w_q, m³
  Eigen::MatrixXd shape_gradient;  // (nodes per element) × (3·points): ∂N/∂X, 1/m; columns 3q…3q+2

  Eigen::VectorXd node_mass;  // n, lumped, kg; the sum is density·volume

  std::shared_ptr<const BlockPattern> pattern;      // shared by all matrices of this body
  std::shared_ptr<const ElementSchedule> schedule;  // the order in which elements are visited

  int NodeCount() const { return static_cast<int>(mesh.NodeCount()); }
  int ElementCount() const { return static_cast<int>(mesh.TetCount()); }
  int PointCount() const { return ElementCount() * points_per_element; }
};

// Discretises a mesh of linear or quadratic tetrahedra with a uniform density (kg/m³). Throws
// InputError if the mesh is empty or refers to a missing node, if an element has no positive volume
// at one of its quadrature points, if a node belongs to no element, or if the density is not
// positive.
Body MakeBody(const TetMesh& mesh, double density);

// The boundary area assigned to each node (n, m²; 0 in the interior): a third of the area of each
// adjacent boundary triangle. A quadratic face is split into four triangles.
Eigen::VectorXd NodeBoundaryAreas(const Body& body);

}  // namespace lacuna

#endif  // LACUNA_FEM_BODY_H_
