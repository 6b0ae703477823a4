// Places of a body at rest that an effect's settings name: near a point, or in a half-space.
#ifndef LACUNA_EFFECTS_REST_REGION_H_
#define LACUNA_EFFECTS_REST_REGION_H_

#include <Eigen/Core>

#include "fem/body.h"

namespace lacuna {

// exp(−|X − c|²/(2 r²)) at each node (n).
Eigen::VectorXd BumpAround(const Eigen::Vector3d& centre, double radius, const Body& body);

// `measure` (n; areas or volumes that belong to the places, 3 × n) times that bump, scaled to the
// sum 1; 0 where it is below 1e-12 of its largest. All falls on the nearest places that have a
// measure when r is small against their distances.
Eigen::VectorXd BumpShares(const Eigen::Vector3d& centre, double radius,
                           const Eigen::Matrix3Xd& places, const Eigen::VectorXd& measure);

// ∂(those shares)/∂c along a coordinate: s_i (X_i − Σ_j s_j X_j)/r².
Eigen::VectorXd BumpSharesByCentre(int axis, double radius, const Eigen::Matrix3Xd& places,
                                   const Eigen::VectorXd& shares);

// Volume around each node (n, m³): its share of the lumped mass by the density.
Eigen::VectorXd NodeVolumes(const Body& body);

// 1 at each node with n·(X − point) ≥ 0, to rounding, else 0 (n). A normal of length zero: 1
// everywhere.
Eigen::VectorXd InHalfSpace(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                            const Body& body);

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_REST_REGION_H_
