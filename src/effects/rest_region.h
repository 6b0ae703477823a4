// Regions of a body at rest that the settings of an effect select: around a point, or in a
// half-space. Points are 3 × n, in m; n counts the nodes of the body unless a function says
// otherwise. A radius must be positive (CHECK).
#ifndef LACUNA_EFFECTS_REST_REGION_H_
#define LACUNA_EFFECTS_REST_REGION_H_

#include <Eigen/Core>

#include "fem/body.h"

namespace lacuna {

// exp(−|X − c|²/(2 r²)) at each node (n), with the centre c and the radius r.
Eigen::VectorXd BumpAround(const Eigen::Vector3d& centre, double radius, const Body& body);

// Shares s of a total: `measure` (n: the areas or volumes of the places, 3 × n) times that bump,
// scaled to the sum 1. Shares below 1e-12 of the largest are 0. If r is small against the distances
// of the places, the nearest places with a measure get everything. Some measure must be positive
// (CHECK).
Eigen::VectorXd BumpShares(const Eigen::Vector3d& centre, double radius,
                           const Eigen::Matrix3Xd& places, const Eigen::VectorXd& measure);

// The derivative of those shares with respect to a coordinate of c: s_i (X_i − Σ_j s_j X_j)/r²,
// 1/m.
Eigen::VectorXd BumpShareDerivatives(int axis, double radius, const Eigen::Matrix3Xd& places,
                                     const Eigen::VectorXd& shares);

// Volume around each node (n), m³: its lumped mass over the density.
Eigen::VectorXd NodeVolumes(const Body& body);

// The part of the boundary area around each node (n, m²) that faces a direction m, of any length. A
// triangle with the outward normal n counts with w = u² (3 − 2u), u = 2 (n·m)² − ½ clamped to [0,
// 1]: fully within 30° of the direction, not at all beyond 60°, smoothly in between, so that the
// part of a curved surface does not depend on where the mesh has its edges. w(n·m) + w(√(1 −
// (n·m)²)) = 1: two sides at right angles share what lies between them. A direction of length zero
// counts everything.
Eigen::VectorXd FacingAreas(const Eigen::Vector3d& direction, const Body& body);

// 1 at each node with n·(X − point) ≥ 0, up to rounding, and 0 elsewhere (n). A normal of length
// zero gives 1 everywhere.
Eigen::VectorXd InHalfSpace(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                            const Body& body);

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_REST_REGION_H_
