// The forces and torques that grips exert on a body.
//
// For the components of a node i that are held the equation of motion is not solved; its residual
//   r_i = m_i a_i − Σ f_i                                     (step_equation.h)
// is the force that the grip exerts on the node, beside any external force there. A reaction of a
// grip is the sum of these forces over its nodes, or of their moments about a point p at rest:
//   F = Σ r_i,   M = Σ (x_i − p) × r_i,
// with the places x_i of the nodes in the deformed state. It has three rows x, y, z, in N or N m. A
// grip exerts no force along axes along which it does not hold. A component that two supports hold
// belongs to the first.
#ifndef LACUNA_FEM_GRIP_REACTION_H_
#define LACUNA_FEM_GRIP_REACTION_H_

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fem/model.h"
#include "fem/step_equation.h"

namespace lacuna {

// Which reaction is wanted.
struct Reaction {
  size_t grip = 0;                       // index in Model::grips
  std::optional<Eigen::Vector3d> about;  // m, p of a torque; absent: a force
};

// The forces r_i on all nodes, 3n, N, at the end of a step at `position` (3n) under an external
// nodal force (3n, N; empty: none). NaN where an effect cannot be evaluated.
Eigen::VectorXd NodalReactions(const StepEquation& equation, const Eigen::VectorXd& position,
                               const Eigen::VectorXd& external_force);

// The reactions, 3·reactions × 1, of nodal forces (3n, N) at nodes at `position` (3n, m).
Eigen::VectorXd SumReactions(const Model& model, const std::vector<Reaction>& reactions,
                             const Eigen::VectorXd& position, const Eigen::VectorXd& forces);

// The derivatives of SumReactions(), 3·reactions × k, where the positions and the nodal forces
// change by `position_by` and `forces_by` (3n × k).
Eigen::MatrixXd SumReactionChanges(const Model& model, const std::vector<Reaction>& reactions,
                                   const Eigen::VectorXd& position, const Eigen::VectorXd& forces,
                                   const Eigen::MatrixXd& position_by,
                                   const Eigen::MatrixXd& forces_by);

}  // namespace lacuna

#endif  // LACUNA_FEM_GRIP_REACTION_H_
