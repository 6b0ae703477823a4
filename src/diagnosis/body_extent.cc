#include "diagnosis/body_extent.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/farthest_first.h"

namespace lacuna {
namespace {

// Centres of parts of about equal volume, each moved to the nearest quadrature point so that it
// lies in the body (S. P. Lloyd, IEEE Trans. Inf. Theory 28, 1982).
Eigen::Matrix3Xd EvenPlaces(const Body& body, const Eigen::Vector3d& first, int most) {
  constexpr int kRounds = 30;
  const int count = std::min(most, static_cast<int>(body.point.cols()));
  const auto nearest_to = [&](const Eigen::Vector3d& place) {
    Eigen::Index nearest;
    (body.point.colwise() - place).colwise().squaredNorm().minCoeff(&nearest);
    return nearest;
  };
  Eigen::Matrix3Xd places = body.point(
      Eigen::all, FarthestFirst(static_cast<int>(body.point.cols()),
                                static_cast<int>(nearest_to(first)), count, [&](int a, int b) {
                                  return (body.point.col(a) - body.point.col(b)).squaredNorm();
                                }));
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, count);
    Eigen::VectorXd volume = Eigen::VectorXd::Zero(count);
    for (Eigen::Index q = 0; q < body.point.cols(); ++q) {
      const Eigen::Vector3d point = body.point.col(q);
      Eigen::Index part;
      (places.colwise() - point).colwise().squaredNorm().minCoeff(&part);
      sum.col(part) += body.weight[q] * point;
      volume[part] += body.weight[q];
    }
    for (int k = 0; k < count; ++k)
      if (volume[k] > 0) places.col(k) = sum.col(k) / volume[k];
  }
  for (int k = 0; k < count; ++k) places.col(k) = body.point.col(nearest_to(places.col(k))).eval();
  return places;
}

}  // namespace

BodyExtent MeasureExtent(const Body& body) {
  BodyExtent extent;
  const Eigen::VectorXd& mass = body.node_mass;
  extent.centre = body.mesh.nodes * mass / mass.sum();
  const Eigen::Matrix3Xd from = body.mesh.nodes.colwise() - extent.centre;
  const Eigen::Matrix3d inertia = from * mass.asDiagonal() * from.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(inertia);
  // Equal moments leave the axes undetermined, as those of a square or round section. They are then
  // chosen close to the coordinate axes.
  constexpr double kDistinct = 1.1;
  const Eigen::Vector3d moment = eigen.eigenvalues();
  Eigen::Vector3d longest = eigen.eigenvectors().col(2);
  if (moment[2] < kDistinct * moment[1]) longest = Eigen::Vector3d::UnitX();
  Eigen::Vector3d second = eigen.eigenvectors().col(1);
  if (moment[1] < kDistinct * moment[0] || moment[2] < kDistinct * moment[1]) {
    Eigen::Index least;
    longest.cwiseAbs().minCoeff(&least);
    second = Eigen::Vector3d::Unit(least);
    second = (second - longest.dot(second) * longest).normalized();
  }
  extent.axis << longest, second, longest.cross(second);
  for (int k = 0; k < 3; ++k) {
    Eigen::Vector3d axis = extent.axis.col(k);
    Eigen::Index largest;
    axis.cwiseAbs().maxCoeff(&largest);
    if (axis[largest] < 0) axis = -axis;
    extent.axis.col(k) = axis;
    const Eigen::RowVectorXd along = axis.transpose() * from;
    extent.length[k] = along.maxCoeff() - along.minCoeff();
  }
  // A body whose width exceeds this share of its length is not a bar.
  constexpr double kBar = 0.4;
  constexpr int kPlaces = 16;
  if (extent.length[1] > kBar * extent.length[0]) {
    extent.places = EvenPlaces(body, extent.centre, kPlaces);
    constexpr double kNear = 1.5;  // distance of adjacent parts, in their width
    extent.spacing = kNear * std::cbrt(body.weight.sum() / kPlaces);
  }
  return extent;
}

}  // namespace lacuna
