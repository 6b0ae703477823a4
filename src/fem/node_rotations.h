// How much a deformed body has turned about each of its nodes.
#ifndef LACUNA_FEM_NODE_ROTATIONS_H_
#define LACUNA_FEM_NODE_ROTATIONS_H_

#include <Eigen/Core>
#include <vector>

#include "fem/body.h"

namespace lacuna {

// The rotation nearest to the deformation gradient averaged, by volume, over the elements of each
// node. `position`: 3n, node-major.
std::vector<Eigen::Matrix3d> NodeRotations(const Body& body, const Eigen::VectorXd& position);

}  // namespace lacuna

#endif  // LACUNA_FEM_NODE_ROTATIONS_H_
