#include "fem/body.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <vector>

#include "core/error.h"
#include "geometry/shape_functions.h"

namespace lacuna {
namespace {

void CheckNodeNumbers(const TetMesh& mesh) {
  if (mesh.TetCount() == 0) throw InputError("the tetrahedral mesh has no element");
  if (mesh.tets.rows() != 4 && mesh.tets.rows() != 10) {
    throw InputError(fmt::format("a tetrahedron has 4 or 10 nodes, not {}", mesh.tets.rows()));
  }
  if (!mesh.nodes.allFinite())
    throw InputError("the tetrahedral mesh has a node that is not finite");
  std::vector<char> used(mesh.NodeCount(), 0);
  for (Eigen::Index e = 0; e < mesh.TetCount(); ++e) {
    for (const int node : mesh.tets.col(e)) {
      if (node < 0 || node >= mesh.NodeCount()) {
        throw InputError(fmt::format("tetrahedron {} refers to node {}; the mesh has nodes 0 to {}",
                                     e, node, mesh.NodeCount() - 1));
      }
      used[node] = 1;
    }
  }
  for (size_t node = 0; node < used.size(); ++node) {
    if (!used[node]) throw InputError(fmt::format("node {} belongs to no tetrahedron", node));
  }
}

void Integrate(Body* body) {
  const TetMesh& mesh = body->mesh;
  const TetQuadrature rule = ElementQuadrature(mesh.Order());
  const int nodes = static_cast<int>(mesh.tets.rows());
  const int points = static_cast<int>(rule.weights.size());
  body->points_per_element = points;
  body->point.resize(3, body->PointCount());
  body->weight.resize(body->PointCount());
  body->shape_gradient.resize(nodes, 3 * body->PointCount());

  std::vector<Eigen::MatrixX3d> reference(points);
  std::vector<Eigen::VectorXd> shape(points);
  for (int p = 0; p < points; ++p) {
    shape[p] = ShapeValues(mesh.Order(), rule.points.col(p));
    reference[p] = ShapeDerivativesAlongEdges(mesh.Order(), rule.points.col(p));
  }

  Eigen::Matrix3Xd corner(3, nodes);
  for (int e = 0; e < body->ElementCount(); ++e) {
    for (int a = 0; a < nodes; ++a) corner.col(a) = mesh.nodes.col(mesh.tets(a, e));
    for (int p = 0; p < points; ++p) {
      const Eigen::Matrix3d jacobian = corner * reference[p];
      const double volume = jacobian.determinant() / 6;
      if (!(volume > 0)) {
        throw InputError(fmt::format(
            "tetrahedron {} (corners {}, {}, {}, {}) has volume {:.3g} m^3; a rest shape needs "
            "positive volumes, corners in right-handed order",
            body->given_element[e], mesh.tets(0, e), mesh.tets(1, e), mesh.tets(2, e),
            mesh.tets(3, e), volume));
      }
      const int q = e * points + p;
      body->point.col(q) = corner * shape[p];
      body->weight[q] = rule.weights[p] * volume;
      body->shape_gradient.middleCols<3>(3 * q) = reference[p] * jacobian.inverse();
    }
  }
}

// The lumping of Hinton, Rock & Zienkiewicz 1976: the diagonal of the consistent mass matrix,
// scaled to the mass of the element. For a straight-sided quadratic tetrahedron the shares are 1/36
// at the corners and 4/27 at the midpoints (row sums would be negative at the corners), for the
// linear one a quarter per corner.
Eigen::VectorXd LumpedMass(const Body& body) {
  const TetMesh& mesh = body.mesh;
  const double corner_share = mesh.Order() == 1 ? 1.0 / 4 : 1.0 / 36;
  const double midpoint_share = 4.0 / 27;
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(mesh.NodeCount());
  for (int e = 0; e < body.ElementCount(); ++e) {
    const double element_mass =
        body.density *
        body.weight.segment(e * body.points_per_element, body.points_per_element).sum();
    for (int a = 0; a < mesh.tets.rows(); ++a) {
      mass[mesh.tets(a, e)] += element_mass * (a < 4 ? corner_share : midpoint_share);
    }
  }
  return mass;
}

}  // namespace

Body MakeBody(const TetMesh& mesh, double density) {
  if (!(density > 0)) {
    throw InputError(fmt::format("the density must be positive, not {} kg/m^3", density));
  }
  CheckNodeNumbers(mesh);
  Body body;
  body.mesh.nodes = mesh.nodes;
  body.given_element = ElementsAlongCurve(mesh);
  body.mesh.tets = mesh.tets(Eigen::all, body.given_element);
  body.boundary = ExtractBoundary(mesh);
  body.density = density;
  Integrate(&body);
  body.node_mass = LumpedMass(body);
  body.pattern =
      std::make_shared<const BlockPattern>(MakeBlockPattern(body.NodeCount(), body.mesh.tets));
  body.schedule =
      std::make_shared<const ElementSchedule>(MakeElementSchedule(body.mesh, *body.pattern));
  return body;
}

Eigen::VectorXd NodeBoundaryAreas(const Body& body) {
  const Eigen::VectorXd areas = VertexAreas(body.boundary.surface);
  Eigen::VectorXd node_areas = Eigen::VectorXd::Zero(body.NodeCount());
  node_areas(body.boundary.node) = areas;
  return node_areas;
}

}  // namespace lacuna
