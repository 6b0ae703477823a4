#include "geometry/shape_functions.h"

#include <cmath>

namespace lacuna {
Eigen::VectorXd ShapeValues(int order, const Eigen::Vector4d& barycentric) {
  if (order == 1) return barycentric;
  Eigen::VectorXd values(10);
  for (int a = 0; a < 4; ++a) values[a] = barycentric[a] * (2 * barycentric[a] - 1);
  for (int k = 0; k < 6; ++k) {
    values[4 + k] = 4 * barycentric[kTetEdges[k][0]] * barycentric[kTetEdges[k][1]];
  }
  return values;
}

Eigen::MatrixX4d ShapeDerivatives(int order, const Eigen::Vector4d& barycentric) {
  if (order == 1) return Eigen::Matrix4d::Identity();
  Eigen::MatrixX4d derivatives = Eigen::MatrixX4d::Zero(10, 4);
  for (int a = 0; a < 4; ++a) derivatives(a, a) = 4 * barycentric[a] - 1;
  for (int k = 0; k < 6; ++k) {
    const auto [a, b] = kTetEdges[k];
    derivatives(4 + k, a) = 4 * barycentric[b];
    derivatives(4 + k, b) = 4 * barycentric[a];
  }
  return derivatives;
}

Eigen::MatrixX3d ShapeDerivativesAlongEdges(int order, const Eigen::Vector4d& barycentric) {
  const Eigen::Matrix<double, 4, 3> along_edges{{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  return ShapeDerivatives(order, barycentric) * along_edges;
}

Eigen::Matrix4Xd NodeCoordinates(int order) {
  if (order == 1) return Eigen::Matrix4d::Identity();
  Eigen::Matrix4Xd coordinates = Eigen::Matrix4Xd::Zero(4, 10);
  coordinates.leftCols<4>().setIdentity();
  for (int k = 0; k < 6; ++k)
    for (const int corner : kTetEdges[k]) coordinates(corner, 4 + k) = 0.5;
  return coordinates;
}

TetQuadrature ElementQuadrature(int order) {
  TetQuadrature rule;
  if (order == 1) {
    rule.points = Eigen::Vector4d::Constant(0.25);
    rule.weights = Eigen::VectorXd::Ones(1);
    return rule;
  }
  const double near = (5 + 3 * std::sqrt(5.0)) / 20;
  const double far = (5 - std::sqrt(5.0)) / 20;
  rule.points = Eigen::Matrix4d::Constant(far);
  rule.points.diagonal().setConstant(near);
  rule.weights = Eigen::VectorXd::Constant(4, 0.25);
  return rule;
}

}  // namespace lacuna
