#include "fem/nodal_recovery.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <cmath>

#include "fem/element_kinematics.h"
#include "geometry/shape_functions.h"

namespace lacuna {
namespace {

using SymmetricTensor = Eigen::Matrix<double, 6, 1>;

// The length of the step in which the internal variables do not change: those of a viscoelastic
// branch would have relaxed in an equilibrium (a step of length 0).
constexpr double kInstant = 1e-12;  // s

// Extrapolates from the points of an element to its nodes: values at the points times this matrix
// (points × nodes) are values at the nodes.
Eigen::MatrixXd PointsToNodes(int order) {
  const TetQuadrature rule = ElementQuadrature(order);
  const Eigen::Matrix4Xd nodes = NodeCoordinates(order);
  if (rule.weights.size() == 1) return Eigen::MatrixXd::Ones(1, nodes.cols());
  // A linear function with the values c at the corners has the values c ξ at the coordinates ξ.
  return rule.points.inverse() * nodes;
}

SymmetricTensor FromMatrix(const Eigen::Matrix3d& A) {
  return {A(0, 0),
          A(1, 1),
          A(2, 2),
          0.5 * (A(1, 2) + A(2, 1)),
          0.5 * (A(0, 2) + A(2, 0)),
          0.5 * (A(0, 1) + A(1, 0))};
}

template <int kNodes>
Eigen::MatrixXd GradientsAtPoints(const Body& body, const Eigen::VectorXd& position) {
  Eigen::MatrixXd gradients(9, body.PointCount());
  for (int e = 0; e < body.ElementCount(); ++e) {
    Eigen::Matrix3d F[QuadraturePoints<kNodes>()];
    FieldGradients<kNodes>(body, e, position, F);
    for (int p = 0; p < QuadraturePoints<kNodes>(); ++p)
      gradients.col(e * QuadraturePoints<kNodes>() + p) = F[p].reshaped();
  }
  return gradients;
}

}  // namespace

double VonMises(const SymmetricTensor& stress) {
  const double mean = stress.head<3>().mean();
  return std::sqrt(1.5 * ((stress.head<3>().array() - mean).square().sum() +
                          2 * stress.tail<3>().squaredNorm()));
}

Eigen::MatrixXd RecoverAtNodes(const Body& body, const Eigen::MatrixXd& at_points) {
  CHECK_EQ(at_points.cols(), body.PointCount());
  const int points = body.points_per_element;
  const Eigen::MatrixXd to_nodes = PointsToNodes(body.mesh.Order());
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(at_points.rows(), body.NodeCount());
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(body.NodeCount());
  for (int e = 0; e < body.ElementCount(); ++e) {
    const double volume = body.weight.segment(e * points, points).sum();
    const Eigen::MatrixXd at_nodes = at_points.middleCols(e * points, points) * to_nodes;
    for (int a = 0; a < body.mesh.tets.rows(); ++a) {
      sum.col(body.mesh.tets(a, e)) += volume * at_nodes.col(a);
      weight[body.mesh.tets(a, e)] += volume;
    }
  }
  return sum * weight.cwiseInverse().asDiagonal();
}

NodalStress RecoverNodalStress(const Model& model, const Eigen::VectorXd& position,
                               const Eigen::VectorXd& velocity, double time,
                               const std::vector<Eigen::VectorXd>& effect_state) {
  const Body& body = *model.body;
  CHECK_EQ(effect_state.size(), model.effects.size());
  const Eigen::VectorXd no_acceleration = Eigen::VectorXd::Zero(position.size());
  Eigen::Matrix3Xd first_stress = Eigen::Matrix3Xd::Zero(3, 3 * body.PointCount());
  for (size_t j = 0; j < model.effects.size(); ++j)
    model.effects[j]->AddStress({.body = body,
                                 .position = position,
                                 .velocity = velocity,
                                 .acceleration = no_acceleration,
                                 .time = time,
                                 .time_step = kInstant,
                                 .state = effect_state[j],
                                 .elasticity = ElasticityOf(model)},
                                &first_stress);
  const Eigen::MatrixXd gradients = WithNodesPerElement(
      body, [&](auto nodes) { return GradientsAtPoints<decltype(nodes)::value>(body, position); });
  Eigen::MatrixXd cauchy(6, body.PointCount());
  for (int q = 0; q < body.PointCount(); ++q) {
    const Eigen::Matrix3d F = gradients.col(q).reshaped(3, 3);
    const Eigen::Matrix3d P = first_stress.middleCols<3>(3 * q);
    cauchy.col(q) = FromMatrix(P * F.transpose() / F.determinant());
  }
  NodalStress recovered;
  recovered.cauchy = RecoverAtNodes(body, cauchy);
  recovered.von_mises.resize(body.NodeCount());
  recovered.stretch.resize(3, body.NodeCount());
  const Eigen::MatrixXd nodal_gradients = RecoverAtNodes(body, gradients);
  for (int node = 0; node < body.NodeCount(); ++node) {
    recovered.von_mises[node] = VonMises(recovered.cauchy.col(node));
    const Eigen::Matrix3d F = nodal_gradients.col(node).reshaped(3, 3);
    recovered.stretch.col(node) = Eigen::JacobiSVD<Eigen::Matrix3d>(F).singularValues();
  }
  return recovered;
}

}  // namespace lacuna
