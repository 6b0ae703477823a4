#include "prediction/grip_placement.h"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "geometry/rotation.h"

namespace lacuna {
namespace {

// J w' is the angular velocity of R(w) while w changes with the rate w'.
Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  const Eigen::Vector3d axis = turn / angle;
  Eigen::Matrix3d cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  const double half = std::sin(0.5 * angle);  // 1 − cos θ = 2 sin²(θ/2), exact for small angles
  return Eigen::Matrix3d::Identity() + 2 * half * half / angle * cross +
         (1 - std::sin(angle) / angle) * cross * cross;
}

}  // namespace

Eigen::VectorXd RigidGripMotion(const Grip& grip, const Eigen::Matrix3Xd& places,
                                const Eigen::Vector3d& shift, const Eigen::Vector3d& rotation,
                                Eigen::Index nodes) {
  const Eigen::Vector3d centre = places.rowwise().mean();
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(3 * nodes);
  for (Eigen::Index i = 0; i < grip.nodes.size(); ++i) {
    const Eigen::Vector3d moved = shift + rotation.cross(places.col(i) - centre);
    for (int axis = 0; axis < 3; ++axis)
      if (grip.axes.Has(axis)) motion[3 * grip.nodes[i] + axis] = moved[axis];
  }
  return motion;
}

Grip PlacedGrip(const Grip& grip, const Eigen::Matrix3Xd& rest, const GripPlacement& placement) {
  Grip placed = grip;
  placed.motion = [motion = grip.motion, at_rest = Eigen::Matrix3Xd(rest(Eigen::all, grip.nodes)),
                   shift = placement.shift,
                   rotation = RotationBy(placement.turn)](double time) -> Eigen::Matrix3Xd {
    const Eigen::Matrix3Xd places = motion ? motion(time) : at_rest;
    const Eigen::Vector3d centre = places.rowwise().mean();
    return (rotation * (places.colwise() - centre)).colwise() + (centre + shift);
  };
  return placed;
}

std::function<Eigen::VectorXd(double time, const Eigen::VectorXd& reaction)> PlacementDerivative(
    const Grip& grip, const Eigen::Matrix3Xd& rest, const GripPlacement& placement, bool turns,
    int axis) {
  const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis), zero = Eigen::Vector3d::Zero();
  return [placed = PlacedGrip(grip, rest, placement), shift = turns ? zero : unit,
          rotation = turns ? Eigen::Vector3d(LeftJacobian(placement.turn) * unit) : zero,
          nodes = rest.cols()](double time, const Eigen::VectorXd&) {
    return RigidGripMotion(placed, placed.motion(time), shift, rotation, nodes);
  };
}

}  // namespace lacuna
