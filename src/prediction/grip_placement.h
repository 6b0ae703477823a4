// Rigid motions of a grip: where it holds the object, against what its recording says.
//
// Let x(t) be the positions of the nodes of a grip that the recording prescribes and c(t) their
// mean. A grip that is displaced by d and rotated by the rotation vector w holds its nodes at
//   c(t) + d + R(w) (x(t) − c(t)).
// Both are constant in time and in the coordinate system of the fixture. The derivatives are
// ∂/∂d_k = e_k and ∂/∂w_k = (J e_k) × R(w) (x − c) with the left Jacobian J of R at w (Chirikjian,
// Stochastic Models, Information Theory, and Lie Groups 2, 2012, Eq. 10.86).
#ifndef LACUNA_PREDICTION_GRIP_PLACEMENT_H_
#define LACUNA_PREDICTION_GRIP_PLACEMENT_H_

#include <Eigen/Core>
#include <functional>

#include "fem/model.h"

namespace lacuna {

struct GripPlacement {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // d, m
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();   // w, rad
};

// The displacements (3 × `nodes`, node-major, m) of the nodes of a grip at `places` (3 × nodes of
// the grip, m) by a translation (m) and a small rotation (rad) about the mean of the places. 0 for
// all other nodes, and along axes along which the grip does not hold.
Eigen::VectorXd RigidGripMotion(const Grip& grip, const Eigen::Matrix3Xd& places,
                                const Eigen::Vector3d& shift, const Eigen::Vector3d& rotation,
                                Eigen::Index nodes);

// The grip at that placement. `rest`: all nodes of the undeformed body, 3 × n, m.
Grip PlacedGrip(const Grip& grip, const Eigen::Matrix3Xd& rest, const GripPlacement& placement);

// Perturbation::grip by component `axis` of the shift, per m, or of the turn, per rad, at that
// placement.
std::function<Eigen::VectorXd(double time, const Eigen::VectorXd& reaction)> PlacementDerivative(
    const Grip& grip, const Eigen::Matrix3Xd& rest, const GripPlacement& placement, bool turns,
    int axis);

}  // namespace lacuna

#endif  // LACUNA_PREDICTION_GRIP_PLACEMENT_H_
