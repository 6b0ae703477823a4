// The rotation of a deformed body at each of its nodes.
//
// Used to rotate a preconditioner along with the body (linear_solver.h).
#ifndef LACUNA_FEM_NODE_ROTATIONS_H_
#define LACUNA_FEM_NODE_ROTATIONS_H_

#include <Eigen/Core>
#include <vector>

#include "fem/body.h"

namespace lacuna {

// Returns for each node the rotation nearest to the mean deformation gradient of its elements,
// weighted by volume, with the nodes at `position` (3n, node-major, m). It is a rotation for
// inverted elements too (polar_decomposition.h).
std::vector<Eigen::Matrix3d> NodeRotations(const Body& body, const Eigen::VectorXd& position);

}  // namespace lacuna

#endif  // LACUNA_FEM_NODE_ROTATIONS_H_
